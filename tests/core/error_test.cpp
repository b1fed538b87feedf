#include <tessera/error.h>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Error, SaysFilePlaceAndReasonInOneLine) {
    const Error e(ErrorCode::kInput, "no such thing", "a.gltf", "/nodes/3");
    EXPECT_STREQ(e.what(), "a.gltf: /nodes/3: no such thing");
    EXPECT_EQ(e.code(), ErrorCode::kInput);
    EXPECT_STREQ(Error(ErrorCode::kUsage, "wrong").what(), "wrong");
}

TEST(Error, HostileNamesCannotBreakTheLine) {
    const Error e(ErrorCode::kInput, "bad\x1b[31m", "a\nb.gltf", "x\ry");
    for (const char* c = e.what(); *c; ++c) EXPECT_GE(static_cast<unsigned char>(*c), 0x20);
}

}  // namespace
}  // namespace tessera
