// Reading text word by word, without copies and without the locale: the words of a line, lines with
// their numbers, numbers rounded correctly (std::from_chars; no libm).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tessera {

class TextCursor {
  public:
    // `joins`: a backslash at the end of a line joins the next one to it.
    // A byte order mark is passed over.
    explicit TextCursor(std::string_view text, bool joins = false)
        : text_(text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text), joins_(joins) {}

    // Goes to the next line; false after the last one. Call it before the first word. Lines end with a
    // line feed, a carriage return or both.
    bool next_line();
    // The next word of the line, empty at its end. Words are parted by blanks and tabs.
    std::string_view word();
    // What is left of the line, without blanks around it; joined lines stay as they are.
    std::string_view rest();

    std::size_t line() const { return line_; }  // from 1
    std::string place() const { return "line " + std::to_string(line_); }
    // Where the text goes on after this line.
    std::size_t offset_after_line() const;

  private:
    bool at_line_end(std::size_t at) const { return at >= text_.size() || text_[at] == '\n' || text_[at] == '\r'; }
    bool skip_blanks();

    std::string_view text_;
    bool joins_;
    bool started_ = false;
    std::size_t at_ = 0, line_ = 0;
};

// The whole word as a number. Too large is infinite, too small 0; "nan" and "inf" are numbers.
std::optional<float> parse_float(std::string_view word);
std::optional<double> parse_double(std::string_view word);
std::optional<long long> parse_integer(std::string_view word);

// The beginning of a word in quotation marks, for errors.
std::string quoted(std::string_view word);

}  // namespace tessera
