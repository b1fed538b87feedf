// Files: choosing codecs, errors that name the file, output that is whole or not there, and the
// hostile collection.
#include "image/files.h"
#include "image/pictures.h"

#include <tessera/error.h>
#include <tessera/image.h>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace tessera {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::same_pixels;
using test::sphere_picture;

// An empty folder that is removed at the end.
class WriteImage : public testing::Test {
  protected:
    WriteImage() {
        std::string pattern = (fs::temp_directory_path() / "tessera-image-XXXXXX").string();
        folder_ = ::mkdtemp(pattern.data());
    }
    ~WriteImage() override { fs::remove_all(folder_); }

    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }
    fs::path folder_;
};

TEST_F(WriteImage, ReadsBackWhatItWrote) {
    const Image image = sphere_picture(50, 40, true);
    write_image(folder_ / "a.png", image);
    EXPECT_TRUE(same_pixels(read_image(folder_ / "a.png"), image));
    write_image(folder_ / "a.JPG", image);
    EXPECT_EQ(read_image(folder_ / "a.JPG").width(), 50);
    write_image(folder_ / "b.jpeg", image);
    EXPECT_EQ(files(), 3u);
}

TEST_F(WriteImage, ReplacesAnOldFileAndKeepsLinks) {
    std::ofstream(folder_ / "a.png") << "old";
    fs::create_symlink(folder_ / "a.png", folder_ / "link.png");
    const Image image = sphere_picture(50, 40);
    write_image(folder_ / "link.png", image);
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.png"));
    EXPECT_TRUE(same_pixels(read_image(folder_ / "a.png"), image));
    EXPECT_EQ(files(), 2u);
}

TEST_F(WriteImage, FailureLeavesNothingBehind) {
    const Image image = test::noise_picture(300, 300);
    for (const char* name : {"a.bmp", "a", "a.png.txt"}) {
        const Error e = error_of([&] { write_image(folder_ / name, image); });
        EXPECT_EQ(e.code(), ErrorCode::kOutput);
        EXPECT_EQ(e.file(), (folder_ / name).string());
    }
    Error e = error_of([&] { write_image(folder_ / "no/such/folder/a.png", image); });
    EXPECT_EQ(e.code(), ErrorCode::kOutput);
    EXPECT_NE(std::string(e.what()).find("a.png"), std::string::npos);
    fs::create_directory(folder_ / "folder.png");
    e = error_of([&] { write_image(folder_ / "folder.png", image); });
    EXPECT_EQ(e.code(), ErrorCode::kOutput);
    EXPECT_EQ(files(), 1u);
}

TEST_F(WriteImage, FullDiskLeavesTheOldFile) {
    const Image image = test::noise_picture(300, 300), old = sphere_picture(8, 8);
    write_image(folder_ / "a.png", old);
    // A limit on the size of files stands for a full disk: a short write, then an error.
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const rlimit small{10000, before.rlim_max};
    const auto previous = std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &small);
    const Error e = error_of([&] { write_image(folder_ / "a.png", image); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, previous);
    EXPECT_EQ(e.code(), ErrorCode::kOutput);
    EXPECT_EQ(e.file(), (folder_ / "a.png").string());
    EXPECT_EQ(files(), 1u);
    EXPECT_TRUE(same_pixels(read_image(folder_ / "a.png"), old));
}

TEST_F(WriteImage, DevicesAreWrittenNotReplaced) {
    if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full";
    fs::create_symlink("/dev/full", folder_ / "full.png");
    const Error e = error_of([&] { write_image(folder_ / "full.png", sphere_picture(8, 8)); });
    EXPECT_EQ(e.code(), ErrorCode::kOutput);
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
    EXPECT_EQ(files(), 1u);
}

TEST_F(WriteImage, UnwritableFolderIsAnOutputError) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
    const Error e = error_of([&] { write_image(folder_ / "a.png", sphere_picture(8, 8)); });
    fs::permissions(folder_, fs::perms::owner_all);
    EXPECT_EQ(e.code(), ErrorCode::kOutput);
    EXPECT_EQ(files(), 0u);
}

TEST_F(WriteImage, ReadErrorsNameTheFile) {
    std::ofstream(folder_ / "text.png") << "no picture";
    for (const char* name : {"text.png", "missing.png", "."}) {
        const Error e = error_of([&] { read_image(folder_ / name); });
        EXPECT_EQ(e.code(), ErrorCode::kInput);
        EXPECT_EQ(e.file(), (folder_ / name).string());
    }
}

TEST(DecodeImage, KnowsFormatsByContent) {
    EXPECT_EQ(read_image_info(encode_png(sphere_picture(9, 7))).codec, "png");
    EXPECT_EQ(read_image_info(encode_jpeg(sphere_picture(9, 7))).codec, "jpeg");
    for (const std::string text : {"", "\x89PN", "\xff\xd8", "GIF89a", "BM......", "#?RADIANCE\n"}) {
        const auto bytes = std::as_bytes(std::span(text));
        EXPECT_EQ(error_of([&] { decode_image(bytes); }).code(), ErrorCode::kInput);
        EXPECT_EQ(error_of([&] { read_image_info(bytes); }).code(), ErrorCode::kInput);
    }
}

// The folder that holds `malformed/` and `models/`.
fs::path collection() {
    const char* set = std::getenv("TESSERA_MODELS");
    return set != nullptr ? fs::path(set) : fs::path(TESSERA_SOURCE_DIR) / ".." / "shared";
}

TEST(DecodeImage, HostileFilesAreErrorsInBoundedMemory) {
    const fs::path folder = collection() / "malformed" / "image";
    if (!fs::is_directory(folder)) GTEST_SKIP() << "no folder " << folder;
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const Error e = error_of([&] { read_image(entry.path()); });
        EXPECT_TRUE(e.code() == ErrorCode::kInput || e.code() == ErrorCode::kLimit) << entry.path();
        EXPECT_EQ(e.file(), entry.path().string());
        ++count;
    }
    ::getrusage(RUSAGE_SELF, &after);
    EXPECT_GT(count, 0);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100 * 1024) << "KiB grown";
}

TEST(DecodeImage, PicturesOfTheModelsDecode) {
    const fs::path folder = collection() / "models";
    if (!fs::is_directory(folder)) GTEST_SKIP() << "no folder " << folder;
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const fs::path extension = entry.path().extension();
        if (extension != ".png" && extension != ".jpg" && extension != ".jpeg") continue;
        try {
            EXPECT_FALSE(read_image(entry.path()).empty());
        } catch (const Error& e) {
            ADD_FAILURE() << e.what();
        }
        ++count;
    }
    EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace tessera
