// The OpenImageIO module: what a process without it says, and that opening it changes nothing else. The
// module is opened once in a process, so each case has a process of its own.
#include "image/files.h"
#include "image/pictures.h"

#include <tessera/image_files.h>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

namespace tessera {
namespace {

class ImageModuleTest : public testing::Test {
  protected:
    ImageModuleTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

// Ends the process with the error of writing an EXR file, if there is one, on stderr.
[[noreturn]] void write_with_module(const char* module) {
    ::setenv("TESSERA_OIIO_MODULE", module, 1);
    int code = 0;
    try {
        encode_image("exr", Image(2, 2, PixelFormat::kRgba32f));
    } catch (const Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        code = e.code() == ErrorCode::kOutput && !has_image_module() ? 7 : 8;
    }
    std::_Exit(code);
}

TEST_F(ImageModuleTest, WithoutItTheMessageSaysHowToGetIt) {
    EXPECT_EXIT(write_with_module("/no/such/module.so"), testing::ExitedWithCode(7),
                "writing EXR needs the OpenImageIO module libtessera_oiio.so .it was not found.: .*libopenimageio-dev");
    // Relative names are not searched for.
    EXPECT_EXIT(write_with_module("libz.so.1"), testing::ExitedWithCode(7), "it was not found");
    EXPECT_EXIT(write_with_module(""), testing::ExitedWithCode(7), "it was not found");
}

TEST_F(ImageModuleTest, OtherObjectsAreRefused) {
    EXPECT_EXIT(write_with_module(TESSERA_SOURCE_DIR "/README.md"), testing::ExitedWithCode(7), "invalid ELF header");
    Dl_info info{};
    ASSERT_NE(::dladdr(reinterpret_cast<const void*>(&std::fopen), &info), 0);
    const std::string library = std::filesystem::canonical(info.dli_fname).string();
    EXPECT_EXIT(write_with_module(library.c_str()), testing::ExitedWithCode(7), "is not of this version of Tessera");
}

// Headers are read without it, and so are the pictures that need it not.
[[noreturn]] void read_without_module() {
    ::setenv("TESSERA_OIIO_MODULE", "/no/such/module.so", 1);
    const std::string tiff("II\x2a\0\x08\0\0\0\2\0\0\1\3\0\1\0\0\0\5\0\0\0\1\1\3\0\1\0\0\0\4\0\0\0\0\0\0\0", 38);
    const ImageInfo info = read_image_info(test::bytes_of(tiff));
    bool fine = info.width == 5 && info.height == 4 && info.codec == "tiff";
    try {
        decode_image(test::bytes_of(tiff));
        fine = false;
    } catch (const Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        fine = fine && e.code() == ErrorCode::kInput;
    }
    const Image image = test::sphere_picture(8, 8);
    fine = fine && test::same_pixels(decode_image(encode_webp(image)), image);
    std::_Exit(fine ? 7 : 8);
}

TEST_F(ImageModuleTest, HeadersAreReadWithoutIt) {
    EXPECT_EXIT(read_without_module(), testing::ExitedWithCode(7), "reading TIFF needs the OpenImageIO module");
}

// Opened by several threads at once; flush-to-zero and the rounding mode stay what they were.
[[noreturn]] void open_from_threads() {
    const unsigned before = _mm_getcsr();
    const Image image = test::noise_picture(40, 30);
    std::vector<char> fine(4, 0);
    std::vector<std::thread> threads;
    for (char& f : fine)
        threads.emplace_back([&image, &f] {
            const unsigned mode = _mm_getcsr();
            for (int i = 0; i < 20; ++i) f = test::same_pixels(decode_image(encode_tiff(image)), image);
            if (((_mm_getcsr() ^ mode) & ~0x3fu) != 0) f = 0;  // all but the sticky flags
        });
    for (std::thread& thread : threads) thread.join();
    const bool all = fine == std::vector<char>(4, 1) && ((_mm_getcsr() ^ before) & ~0x3fu) == 0;
    std::_Exit(all ? 7 : 8);
}

TEST_F(ImageModuleTest, ThreadsOpenItTogether) {
    if (!has_image_module()) GTEST_SKIP() << "built without the OpenImageIO module";
    EXPECT_EXIT(open_from_threads(), testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace tessera
