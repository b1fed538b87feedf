// Pictures of scenes in other formats than PNG and JPEG: EXT_texture_webp, KHR_texture_basisu, the maps of
// MTL, and what the shading cannot use.
#include "load/gltf_text.h"
#include "load/temporary_folder.h"
#include "load/test_files.h"

#include <tessera/image_files.h>

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

namespace tessera {
namespace {

namespace fs = std::filesystem;

Image flat(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
    Image image(4, 4, PixelFormat::kRgba8);
    for (std::size_t i = 0; i < 64; i += 4) {
        auto* p = image.data<std::uint8_t>() + i;
        p[0] = r, p[1] = g, p[2] = b, p[3] = 255;
    }
    return image;
}

std::string data_uri(const std::string& type, const std::vector<std::byte>& file) {
    std::vector<std::uint8_t> bytes;
    for (const std::byte b : file) bytes.push_back(static_cast<std::uint8_t>(b));
    return "data:image/" + type + ";base64," + to_base64(bytes);
}

const std::vector<std::byte>& webp() {
    static const std::vector<std::byte> file = encode_webp(flat(10, 200, 30));
    return file;
}

// A document with the pictures 0: red PNG, 1: green WebP, 2: the head of a KTX2 file, and one texture.
std::string textured(const std::string& texture, const std::string& more = "") {
    std::vector<std::byte> ktx2;
    for (const unsigned char c : std::string("\xabKTX 20\xbb\r\n\x1a\n")) ktx2.push_back(static_cast<std::byte>(c));
    std::string text = more;
    text.append("\"images\":[{\"uri\":\"").append(data_uri("png", encode_png(flat(200, 10, 30))));
    text.append("\"},{\"uri\":\"").append(data_uri("webp", webp()));
    text.append("\"},{\"uri\":\"").append(data_uri("ktx2", ktx2));
    text.append("\"}],\"textures\":[{").append(texture);
    text.append("}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}]");
    return gltf_text(text);
}

// Green of the first pixel of the texture's picture; -1 where it has none.
int green_of(const Scene& scene) {
    const int picture = scene.textures.at(0).picture;
    if (picture == kNone || !scene.pictures[static_cast<std::size_t>(picture)].pixels) return -1;
    return scene.pictures[static_cast<std::size_t>(picture)].pixels->data<std::uint8_t>()[1];
}

TEST(PictureFormats, WebpOfTheExtensionComesFirst) {
    const std::string extension = "\"extensions\":{\"EXT_texture_webp\":{\"source\":1}}";
    for (const std::string& texture : {"\"source\":0," + extension, extension, std::string("\"source\":1")}) {
        const Scene scene = load_text(textured(texture));
        EXPECT_EQ(green_of(scene), 200) << texture;
        EXPECT_FALSE(warned(scene, "texture"));
        EXPECT_TRUE(scene.extensions_ignored.empty());
    }
    const Scene plain = load_text(textured("\"source\":0,\"extensions\":{\"EXT_texture_webp\":{}}"));
    EXPECT_EQ(green_of(plain), 10) << "an extension that names no picture changes nothing";
    EXPECT_EQ(load_error(textured(extension, "\"extensionsRequired\":[\"EXT_texture_webp\"],")), "");
    EXPECT_NE(load_error(textured("\"extensions\":{\"EXT_texture_webp\":{\"source\":3}}")).find("/textures/0"),
              std::string::npos);
}

TEST(PictureFormats, BasisFallsBackOrIsRefused) {
    const std::string extension = "\"extensions\":{\"KHR_texture_basisu\":{\"source\":2}}";
    const Scene fallback = load_text(textured("\"source\":0," + extension));
    EXPECT_EQ(green_of(fallback), 10);
    EXPECT_TRUE(
        warned(fallback, "/textures/0: pictures in KTX2 (KHR_texture_basisu) are not read; its plain source is used"));
    const Scene none = load_text(textured(extension));
    EXPECT_EQ(green_of(none), -1);
    EXPECT_TRUE(warned(none, "the texture is left out"));
    const Scene plain = load_text(textured("\"source\":2"));
    EXPECT_EQ(green_of(plain), -1);
    EXPECT_TRUE(warned(plain, "KTX2"));
    const std::string required = load_error(textured(extension, "\"extensionsRequired\":[\"KHR_texture_basisu\"],"));
    EXPECT_NE(required.find("KHR_texture_basisu; pictures in KTX2 are not read"), std::string::npos);
}

TEST(PictureFormats, FloatingPointTexturesAreRefusedByName) {
    const Image image(4, 4, PixelFormat::kRgba32f);
    const std::string text =
        gltf_text("\"images\":[{\"uri\":\"" + data_uri("vnd.radiance", encode_hdr(image)) +
                  "\"}],\"textures\":[{\"source\":0}],"
                  "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}]");
    const std::string error = load_error(text);
    EXPECT_NE(error.find("/images/0"), std::string::npos);
    EXPECT_NE(error.find("floating-point values"), std::string::npos);
}

// Textures are named as what they are, and only formats that can be one are offered.
TEST(PictureFormats, ForeignTexturesAreNamed) {
    const std::string zeros(60, '\0');
    const std::string tga = std::string("\0\0\2\0\0\0\0\0\0\0\0\0\4\0\4\0\x18\0", 18) + zeros;
    for (const auto& [content, reason] : {std::pair("BM" + zeros, "pictures in BMP are not read"),
                                          {"GIF89a" + zeros, "pictures in GIF are not read"},
                                          {tga, "pictures in TGA are not read"},
                                          {"8BPS" + zeros, "pictures in PSD are not read"},
                                          {"what" + zeros, "not a picture that can be a texture"}}) {
        std::vector<std::byte> file(content.size());
        std::memcpy(file.data(), content.data(), content.size());
        const std::string error =
            load_error(gltf_text("\"images\":[{\"uri\":\"" + data_uri("x", file) +
                                 "\"}],\"textures\":[{\"source\":0}],"
                                 "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}]"));
        EXPECT_NE(error.find(reason), std::string::npos) << error;
        EXPECT_EQ(error.find("EXR"), std::string::npos) << error;
    }
}

void write(const fs::path& path, const std::vector<std::byte>& file) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
}

TEST(PictureFormats, MapsOfMtl) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    const auto load = [&](const std::string& name, const std::vector<std::byte>& file) {
        std::ofstream(folder.path() / "a.mtl") << "newmtl m\nmap_Kd " << name << "\n";
        write(folder.path() / name, file);
        return load_scene((folder.path() / "a.obj").string());
    };
    EXPECT_EQ(green_of(load("a.webp", webp())), 200);
    if (has_image_module()) {
        EXPECT_EQ(green_of(load("a.tif", encode_tiff(flat(1, 77, 3)))), 77);
    }
    const Scene floats = load("a.hdr", encode_hdr(Image(4, 4, PixelFormat::kRgba32f)));
    EXPECT_EQ(green_of(floats), -1);
    EXPECT_TRUE(warned(floats, "floating-point values"));
}

// Other people's files: each of the four kinds of WebP, all of them red.
TEST(PictureFormats, WebpOfTheValidator) {
    const fs::path images = test_folder() / "malformed/khronos-validator/ext/EXT_texture_webp/data/image";
    if (!fs::exists(images)) GTEST_SKIP() << "no " << images;
    for (const char* name : {"VP8_red", "VP8L_red", "VP8L_red_transparent", "VP8X_red_transparent"}) {
        const Image image = read_image((images / (std::string(name) + ".webp")).string());
        const auto* p = image.data<std::uint8_t>();
        EXPECT_GT(p[0], 250) << name;
        EXPECT_LT(p[1], 5);
        EXPECT_LT(p[2], 5);
        EXPECT_EQ(p[3] < 255, std::string(name).ends_with("transparent")) << name;
    }
}

// Radiance's and OpenEXR's own writers made these: all finite, none negative.
TEST(PictureFormats, FloatingPointFilesOfTheModels) {
    int count = 0;
    for (const char* sub_folder : {"env", "curves"})
        for (const std::string& name : models_in(sub_folder, {".hdr", ".exr"})) {
            if (name.ends_with(".exr") && !has_image_module()) continue;
            const Image image = read_image(name, {1u << 24, false, true});
            ASSERT_EQ(image.format(), PixelFormat::kRgba32f);
            double sum = 0;
            for (std::size_t i = 0; i < image.bytes().size() / 4; ++i) {
                ASSERT_TRUE(image.data<float>()[i] >= 0 && image.data<float>()[i] < 1e6f) << name;
                sum += image.data<float>()[i];
            }
            EXPECT_GT(sum, 0) << name;
            ++count;
        }
    if (count == 0) GTEST_SKIP() << "no models: set TESSERA_MODELS";
}

}  // namespace
}  // namespace tessera
