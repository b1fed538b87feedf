// Every hostile or odd scene file of the corpus gives what its manifest says.
#include "test_files.h"

#include <tessera/error.h>
#include <tessera/load.h>

#include <gtest/gtest.h>

namespace tessera {
namespace {

class Malformed : public testing::TestWithParam<MalformedCase> {};

TEST_P(Malformed, GivesWhatTheManifestSays) {
    const std::string path = (test_folder() / "malformed" / GetParam().file).string();
    try {
        const Scene scene = load_scene(path);
        EXPECT_NE(GetParam().expected, "error") << "loaded, though it is malformed";
        EXPECT_NO_THROW(validate(scene));
    } catch (const Error& error) {
        EXPECT_NE(GetParam().expected, "clean") << error.what();
        EXPECT_TRUE(error.code() == ErrorCode::kInput || error.code() == ErrorCode::kLimit) << error.what();
        const std::string line = error.what();
        EXPECT_EQ(line.find('\n'), std::string::npos);
        EXPECT_NE(line.find(path), std::string::npos) << line;
        EXPECT_GT(line.size(), path.size() + 2) << "no reason is given";
        RecordProperty("error", line);
    }
}

std::string test_name(const testing::TestParamInfo<MalformedCase>& info) {
    std::string name = info.param.file;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(SAFE, Malformed, testing::ValuesIn(malformed_cases()), test_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Malformed);

TEST(MalformedCorpus, IsThere) {
    if (malformed_cases().empty()) GTEST_SKIP() << "no malformed files: set TESSERA_MODELS";
    EXPECT_GT(malformed_cases().size(), 100u);
}

}  // namespace
}  // namespace tessera
