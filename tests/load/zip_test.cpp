// ZIP archives: the scene in them, the files beside it, and what is hostile.
#include "mesh_files.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>

#include <minizip/zip.h>
#include <zlib.h>

#include <fstream>
#include <iterator>
#include <map>

namespace tessera {
namespace {

std::string zip_of(const std::map<std::string, std::string>& files, const char* password = nullptr) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "made.zip").string();
    const zipFile zip = zipOpen64(path.c_str(), APPEND_STATUS_CREATE);
    for (const auto& [name, contents] : files) {
        const auto crc = crc32(0, reinterpret_cast<const Bytef*>(contents.data()), static_cast<uInt>(contents.size()));
        EXPECT_EQ(zipOpenNewFileInZip3_64(zip, name.c_str(), nullptr, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED, 6, 0,
                                          -MAX_WBITS, DEF_MEM_LEVEL, Z_DEFAULT_STRATEGY, password, crc, 0),
                  ZIP_OK);
        zipWriteInFileInZip(zip, contents.data(), static_cast<unsigned>(contents.size()));
        zipCloseFileInZip(zip);
    }
    EXPECT_EQ(zipClose(zip, nullptr), ZIP_OK);
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

const std::string kTriangle = "mtllib ./materials/m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";

TEST(Zip, ReadsTheSceneAndWhatLiesBesideIt) {
    const Scene scene = load_text(zip_of({{"readme.txt", "hello"},
                                          {"__MACOSX/a.obj", "no scene"},
                                          {"deep/er/b.obj", "no scene"},
                                          {"scene/z.obj", "no scene"},
                                          {"scene/Model.OBJ", kTriangle},
                                          {"scene/materials/m.mtl", "newmtl red\nKd 1 0 0\n"}}),
                                  "thing.zip");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    EXPECT_EQ(scene.materials[0].diffuse, (Vec3{1, 0, 0}));
    // By content, whatever the name; and glTF with a buffer of its own.
    const std::string corners(36, '\0');
    const Scene gltf = load_text(
        zip_of({{"a/scene.gltf",
                 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"b%69n/data.bin\"}],"
                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
                 "\"componentType\":5126,\"type\":\"VEC3\",\"count\":3}],\"meshes\":[{\"primitives\":[{"
                 "\"attributes\":{\"POSITION\":0}}]}]}"},
                {"a/bin/data.bin", corners}}),
        "<stdin>");
    EXPECT_EQ(gltf.meshes[0].primitives[0].positions.size(), 3u);
}

TEST(Zip, NamesFilesByTheirPlaceInTheArchive) {
    const std::string error = load_error(zip_of({{"s/bad.obj", "v 0 0 0\nf 1 2 3\n"}}), "thing.zip");
    EXPECT_NE(error.find("thing.zip/s/bad.obj: line 2"), std::string::npos) << error;
}

// Names as archivers write them, and paths that lead through the folder above.
TEST(Zip, NamesAreBroughtIntoOneForm) {
    const std::string library = "newmtl red\nKd 1 0 0\n";
    const std::string up = "mtllib ../materials/m.mtl\n" + kTriangle.substr(kTriangle.find('\n') + 1);
    using Files = std::map<std::string, std::string>;
    for (const Files& files : {Files{{"./s/a.obj", kTriangle}, {"./s/materials/m.mtl", library}},
                               Files{{"s\\a.obj", kTriangle}, {"s\\materials\\m.mtl", library}},
                               Files{{"s/a.obj", up}, {"materials/m.mtl", library}}}) {
        const Scene scene = load_text(zip_of(files), "thing.zip");
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        EXPECT_EQ(scene.materials.at(0).diffuse, (Vec3{1, 0, 0})) << files.begin()->first;
    }
    EXPECT_NE(load_error(zip_of({{"./s/bad.obj", "f 1 2 3\n"}}), "thing.zip").find("thing.zip/s/bad.obj: line 1"),
              std::string::npos);
}

TEST(Zip, NamesThePackingThatIsNotRead) {
    const std::string whole = zip_of({{"a.obj", kTriangle}});
    for (const auto& [method, name] : {std::pair(12, "bzip2"), {14, "LZMA"}, {93, "Zstandard"}, {77, "method 77"}}) {
        std::string zip = whole;  // the method stands in both headers of the file
        zip[8] = zip[zip.find("PK\x01\x02") + 10] = static_cast<char>(method);
        const std::string error = load_error(zip, "x.zip");
        EXPECT_NE(error.find(std::string("is packed with ") + name), std::string::npos) << error;
    }
}

TEST(Zip, HostileArchivesAreRefused) {
    const auto expect = [](const std::string& zip, const std::string& reason, const LoadOptions& options = {}) {
        const std::string error = load_error(zip, "x.zip", options);
        EXPECT_NE(error.find(reason), std::string::npos) << error;
    };
    expect(zip_of({{"readme.txt", "hello"}}), "holds no scene");
    expect(std::string("PK\x03\x04") + std::string(100, 'x'), "no ZIP archive");
    expect(zip_of({{"a.obj", kTriangle}}, "secret"), "is encrypted");
    // Nothing outside is opened, whatever it is called.
    const std::string leaving =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":1,\"uri\":\"../../b.bin\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":1}],\"accessors\":[{\"bufferView\":0,\"componentType\":5121,"
        "\"type\":\"SCALAR\",\"count\":1}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}";
    expect(zip_of({{"a/s.gltf", leaving}, {"b.bin", "x"}}), "leaves the archive");
    // A bomb: the sizes count before anything is unpacked.
    LoadOptions small;
    small.max_bytes = 1 << 20;
    expect(zip_of({{"a.obj", std::string(8 << 20, '\n')}}), "", small);
    expect(zip_of({{"a.obj", std::string(8 << 20, '\n')}}), "beyond the limit", small);
    // Damage in the packed data, and cut ends.
    std::string text;
    for (int i = 0; i < 2000; ++i) text += "v " + std::to_string(i * 7919 % 1000) + " 0 0\n";
    const std::string whole = zip_of({{"a.obj", text}});
    std::string damaged = whole;
    damaged[200] = static_cast<char>(damaged[200] ^ 0x55);
    EXPECT_NE(load_error(damaged, "x.zip"), "");
    for (std::size_t size = 4; size < whole.size(); size += 97)
        EXPECT_NE(load_error(whole.substr(0, size), "x.zip"), "");
}

}  // namespace
}  // namespace tessera
