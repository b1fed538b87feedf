// Words, lines and numbers of text formats.
#include "load/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace tessera {
namespace {

std::vector<std::vector<std::string>> words_of(std::string_view text, bool joins = false) {
    std::vector<std::vector<std::string>> lines;
    TextCursor cursor(text, joins);
    while (cursor.next_line()) {
        lines.emplace_back();
        for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word())
            lines.back().emplace_back(word);
    }
    return lines;
}

using Lines = std::vector<std::vector<std::string>>;

TEST(TextCursor, LinesEndInThreeWays) {
    const Lines want{{"a", "b"}, {}, {"c"}};
    EXPECT_EQ(words_of("a b\n\nc\n"), want);
    EXPECT_EQ(words_of("a \t b\r\n\r\n  c  \r\n"), want);
    EXPECT_EQ(words_of("a b\r\rc"), want);
    EXPECT_EQ(words_of("\xef\xbb\xbf"
                       "a b\n\nc"),
              want);
    EXPECT_EQ(words_of(""), Lines{});
    EXPECT_EQ(words_of("\n"), Lines{{}});
}

TEST(TextCursor, BackslashesJoinLinesWhereTheyMay) {
    EXPECT_EQ(words_of("f 1 \\\n 2\\\r\n3\ng", true), (Lines{{"f", "1", "2", "3"}, {"g"}}));
    EXPECT_EQ(words_of("f 1 \\\n2", false), (Lines{{"f", "1", "\\"}, {"2"}}));
    EXPECT_EQ(words_of("map a\\b", true), (Lines{{"map", "a\\b"}}));
}

TEST(TextCursor, CountsLinesAndGivesTheRest) {
    TextCursor cursor("one\ntwo words  here \t\nthree", true);
    cursor.next_line();
    cursor.next_line();
    EXPECT_EQ(cursor.word(), "two");
    EXPECT_EQ(cursor.rest(), "words  here");
    EXPECT_EQ(cursor.rest(), "");
    EXPECT_EQ(cursor.place(), "line 2");
    EXPECT_EQ(cursor.offset_after_line(), 22u);
    ASSERT_TRUE(cursor.next_line());
    EXPECT_EQ(cursor.word(), "three");
    EXPECT_FALSE(cursor.next_line());
}

TEST(TextNumbers, AreRoundedCorrectly) {
    EXPECT_EQ(parse_float("0.1"), 0.1f);
    EXPECT_EQ(parse_float("+2.5"), 2.5f);
    EXPECT_EQ(parse_float("-.5e1"), -5.0f);
    EXPECT_EQ(parse_float("1e-3"), 0.001f);
    // Half way between two floats but for its last digit, which a double drops.
    EXPECT_EQ(parse_float("1.00000005960464477539062500001"), std::nextafter(1.0f, 2.0f));
    EXPECT_EQ(parse_float("1.0000000596046447753906250"), 1.0f);
    EXPECT_EQ(parse_float("1e-60"), 0.0f);
    EXPECT_TRUE(std::isinf(*parse_float("1e60")));
    EXPECT_TRUE(std::isinf(*parse_float("1" + std::string(1000, '0'))));
    EXPECT_EQ(parse_float("0." + std::string(1000, '0') + "1"), 0.0f);
    EXPECT_TRUE(std::isnan(*parse_float("nan")));
    for (const char* word :
         {"", "-", "+", "1.5x", "x", "1 2", "--1", "+-1", "0x10", "1e50x", "1e-50/", "1e999junk", "1e-999junk"})
        EXPECT_FALSE(parse_float(word)) << word;
    EXPECT_EQ(parse_integer("-12"), -12);
    EXPECT_FALSE(parse_integer("99999999999999999999"));
    EXPECT_FALSE(parse_integer("1.0"));
}

}  // namespace
}  // namespace tessera
