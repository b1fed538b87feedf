// URIs stay below the scene's folder; base64 is strict; only regular files are read.
#include "load/uri.h"
#include "load/base64.h"

#include "temporary_folder.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

namespace tessera {
namespace {

std::string decode(std::string_view text) {
    const std::optional<std::size_t> size = base64_size(text);
    if (!size) return "?";
    std::string out(*size, '\0');
    return base64_decode(text, reinterpret_cast<std::byte*>(out.data())) ? out : "?";
}

// RFC 4648, section 10.
TEST(Base64, TestVectorsOfTheRfc) {
    EXPECT_EQ(decode(""), "");
    EXPECT_EQ(decode("Zg=="), "f");
    EXPECT_EQ(decode("Zm8="), "fo");
    EXPECT_EQ(decode("Zm9v"), "foo");
    EXPECT_EQ(decode("Zm9vYg=="), "foob");
    EXPECT_EQ(decode("Zm9vYmE="), "fooba");
    EXPECT_EQ(decode("Zm9vYmFy"), "foobar");
    EXPECT_EQ(decode("+/+/"), "\xfb\xff\xbf");
}

TEST(Base64, RefusesWhatIsNotStrict) {
    for (const char* text : {"Z", "Zg", "Zg=", "Zg===", "=Zg=", "====", "Z===", "Zm9v\n", "Zm 9v", "Zm9-", "Zm9_",
                             "Zh==", "Zm9=", "Zg==Zg==", "Zm9v====", "Zm\0v"})
        EXPECT_EQ(decode(text), "?") << text;
}

class Uri : public testing::Test {
  protected:
    Uri() {
        std::filesystem::create_directories(folder_.path() / "scene" / "sub folder");
        write(folder_.path() / "outside.bin", "outside");
        write(folder_.path() / "scene" / "in.bin", "inside");
        write(folder_.path() / "scene" / "sub folder" / "a+b%.bin", "sub");
    }
    static void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }
    std::string scene() const { return (folder_.path() / "scene").string(); }
    // The file's text, or the error's message in brackets.
    std::string read(const std::string& uri, const std::string& folder) {
        LoadContext context("scene.gltf", {});
        try {
            const FileHandle file = open_below(context, folder, uri, "/buffers/0/uri");
            const Bytes bytes = read_open_file(context, file, UINT64_MAX, "");
            return {reinterpret_cast<const char*>(bytes.span().data()), bytes.size()};
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kInput);
            return "[" + std::string(error.what()) + "]";
        }
    }
    std::string read(const std::string& uri) { return read(uri, scene()); }

    TemporaryFolder folder_;
};

TEST_F(Uri, OpensWhatIsBelow) {
    EXPECT_EQ(read("in.bin"), "inside");
    EXPECT_EQ(read("./in.bin"), "inside");
    EXPECT_EQ(read("i%6E.bin"), "inside");
    EXPECT_EQ(read("sub%20folder/a+b%25.bin"), "sub");
    EXPECT_EQ(read("sub folder//a+b%25.bin"), "sub");
}

TEST_F(Uri, RefusesWhatLeavesTheFolder) {
    const std::string absolute = (folder_.path() / "outside.bin").string();
    for (const std::string& uri : {std::string("../outside.bin"),
                                   std::string("%2e%2e/outside.bin"),
                                   std::string("%2E%2E%2Foutside.bin"),
                                   std::string("sub folder/../../outside.bin"),
                                   std::string("sub folder/../in.bin"),
                                   absolute,
                                   "file://" + absolute,
                                   "FILE:" + absolute,
                                   std::string("%2Fetc/passwd"),
                                   std::string("http://example.org/x"),
                                   std::string("..\\outside.bin"),
                                   std::string("..%5Coutside.bin"),
                                   std::string("in.bin%00.png"),
                                   std::string(""),
                                   std::string("."),
                                   std::string("in.bin/"),
                                   std::string("sub folder"),
                                   std::string("%zz"),
                                   std::string("%4"),
                                   std::string("missing.bin"),
                                   std::string("c:in.bin"),
                                   std::string("in.bin/x")})
        EXPECT_EQ(read(uri).substr(0, 1), "[") << uri << " gave " << read(uri);
}

TEST_F(Uri, ErrorsNameFileAndPlace) {
    EXPECT_EQ(read("../outside.bin"), "[scene.gltf: /buffers/0/uri: \"../outside.bin\": leaves the scene's folder]");
}

TEST_F(Uri, FollowsLinksOnlyInside) {
    std::filesystem::create_symlink("in.bin", folder_.path() / "scene" / "link_in.bin");
    std::filesystem::create_symlink("../outside.bin", folder_.path() / "scene" / "link_out.bin");
    std::filesystem::create_directory_symlink("..", folder_.path() / "scene" / "up");
    std::filesystem::create_directory_symlink("sub folder", folder_.path() / "scene" / "sub");
    std::filesystem::create_symlink("loop", folder_.path() / "scene" / "loop");
    EXPECT_EQ(read("link_in.bin"), "inside");
    EXPECT_EQ(read("sub/a+b%25.bin"), "sub");
    EXPECT_EQ(read("link_out.bin").front(), '[');
    EXPECT_EQ(read("up/outside.bin").front(), '[');
    EXPECT_EQ(read("loop").front(), '[');
}

TEST_F(Uri, NeverWaitsForFifosNorReadsDevices) {
    ASSERT_EQ(::mkfifo((folder_.path() / "scene" / "fifo").c_str(), 0600), 0);
    EXPECT_NE(read("fifo").find("is not a regular file"), std::string::npos);
    EXPECT_NE(read("zero", "/dev").find("is not a regular file"), std::string::npos);
    LoadContext context("fifo", {});
    EXPECT_THROW((void)read_whole_file(context, (folder_.path() / "scene" / "fifo").string()), Error);
    EXPECT_THROW((void)read_whole_file(context, "/dev/zero"), Error);
    EXPECT_THROW((void)read_whole_file(context, folder_.path().string()), Error);
    EXPECT_THROW((void)read_whole_file(context, std::string("/etc/hostname\0x", 15)), Error);
}

TEST_F(Uri, WithoutAFolderNothingIsOpened) { EXPECT_EQ(read("in.bin", "").front(), '['); }

TEST(DataUri, BothEncodings) {
    LoadContext context("x", {});
    const auto text = [&](std::string_view uri) {
        const Bytes bytes = decode_data_uri(context, uri, "");
        return std::string(reinterpret_cast<const char*>(bytes.span().data()), bytes.size());
    };
    EXPECT_TRUE(is_data_uri("DATA:,x"));
    EXPECT_FALSE(is_data_uri("data"));
    EXPECT_EQ(text("data:application/octet-stream;base64,Zm9v"), "foo");
    EXPECT_EQ(text("data:;BASE64,Zm9v"), "foo");
    EXPECT_EQ(text("data:text/plain,a%20b"), "a b");
    // What writers make of base64.
    for (const char* data : {"Zm9vYg", "Zm9vYg%3D%3D", "Zm9v\nYg==", " Zm9v\r\n\tYg", "Zm9%76Yg=="})
        EXPECT_EQ(text(std::string("data:;base64,") + data), "foob") << data;
    EXPECT_THROW(text("data:;base64,Zm9vY"), Error);
    EXPECT_THROW(text("data:;base64,Zm9v%4"), Error);
    EXPECT_THROW(text("data:;base64,Zm9vYg="), Error);
    EXPECT_EQ(text("data:,"), "");
    EXPECT_THROW(text("data:;base64,Zm9"), Error);
    EXPECT_THROW(text("data:;base64,Zm9!"), Error);
    EXPECT_THROW(text("data:;base64"), Error);
}

TEST(Budget, IsExact) {
    LoadOptions options;
    options.max_bytes = 100;
    LoadContext context("x", options);
    context.charge(60);
    context.charge(40);
    EXPECT_NO_THROW(context.charge(0));
    try {
        context.charge(1);
        FAIL() << "beyond the limit";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kLimit);
    }
    EXPECT_THROW(context.charge(UINT64_MAX), Error);
}

TEST(Warnings, AreBoundedAndOneLine) {
    LoadContext context("x", {});
    context.warn("a\nb\x1b[31m" + std::string(1000, 'x'));
    EXPECT_EQ(context.warnings()[0].find_first_of("\n\x1b"), std::string::npos);
    EXPECT_LE(context.warnings()[0].size(), 400u);
    for (int i = 0; i < 10000; ++i) context.warn("more");
    EXPECT_EQ(context.warnings().size(), 65u);
}

}  // namespace
}  // namespace tessera
