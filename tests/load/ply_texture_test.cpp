// PLY with pictures: texture coordinates of the corners of faces give the scene of an OBJ twin.
#include "mesh_files.h"
#include "temporary_folder.h"

#include <tessera/image.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

namespace tessera {
namespace {

// A cube whose six faces each show the whole picture: every vertex has three normals and texture coordinates.
constexpr float kCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr int kFaces[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}, {3, 0, 4, 7}};
constexpr float kUv[4][2] = {{0, 0}, {1, 0}, {1, 0.75f}, {0, 0.75f}};

std::string obj_cube() {
    std::ostringstream text;
    text << "mtllib m.mtl\nusemtl m\n";
    for (const auto& v : kCorners) text << "v " << v[0] << " " << v[1] << " " << v[2] << "\n";
    for (const auto& t : kUv) text << "vt " << t[0] << " " << t[1] << "\n";
    for (const auto& f : kFaces) {
        text << "f";
        for (int k = 0; k < 4; ++k) text << " " << f[k] + 1 << "/" << k + 1;
        text << "\n";
    }
    return text.str();
}

enum class Form { kAscii, kBinary };

// `textures`: the pictures' names; a face takes number i % their number.
std::string ply_cube(Form form, const std::vector<std::string>& textures) {
    const bool binary = form == Form::kBinary;
    std::string text = "ply\nformat ";
    text += binary ? "binary_little_endian 1.0\n" : "ascii 1.0\n";
    for (const std::string& name : textures) text += "comment TextureFile " + name + "\n";
    text +=
        "element vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\n"
        "property list uchar float texcoord\nproperty int texnumber\nproperty list uchar int vertex_indices\n"
        "end_header\n";
    const auto add = [&](auto value) {
        if (!binary) {
            text.append(std::to_string(value)).append(" ");
            return;
        }
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        text.append(bytes, sizeof value);
    };
    for (const auto& v : kCorners)
        for (const float c : v) add(c);
    for (int f = 0; f < 6; ++f) {
        add(static_cast<std::uint8_t>(8));
        for (const auto& uv : kUv) add(uv[0]), add(uv[1]);
        add(f % static_cast<int>(std::max<std::size_t>(textures.size(), 1)));
        add(static_cast<std::uint8_t>(4));
        for (const int v : kFaces[f]) add(v);
        if (!binary) text += "\n";
    }
    return text;
}

using Corner = std::array<float, 8>;
std::vector<std::array<Corner, 3>> triangles_of(const Primitive& p) {
    std::vector<std::array<Corner, 3>> all;
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        std::array<Corner, 3> t;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = p.indices[i + k];
            const Vec3 &at = p.positions[v], &n = p.normals[v];
            const Vec2& uv = p.texcoords.at(0)[v];
            t[k] = {at.x, at.y, at.z, n.x, n.y, n.z, uv.x, uv.y};
        }
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());  // the winding stays
        all.push_back(t);
    }
    std::sort(all.begin(), all.end());
    return all;
}

class PlyTextures : public testing::Test {
  protected:
    void SetUp() override {
        for (const auto& [name, grey] : {std::pair("a.png", 10), {"b.png", 200}}) {
            Image image(1, 1, PixelFormat::kRgba8);
            std::memset(image.data<std::uint8_t>(), grey, 4);
            write_image((folder.path() / name).string(), image);
        }
        std::ofstream(folder.path() / "m.mtl") << "newmtl m\nmap_Kd a.png\n";
    }
    Scene load(const std::string& text, const std::string& name) {
        return load_text(text, name, {}, folder.path().string());
    }
    static int grey(const Scene& scene, const Primitive& p) {
        const Material& m = scene.materials.at(static_cast<std::size_t>(p.material));
        const int texture = m.texture(TextureSlot::kBaseColor).texture;
        if (texture == kNone) return -1;
        const int picture = scene.textures.at(static_cast<std::size_t>(texture)).picture;
        return scene.pictures.at(static_cast<std::size_t>(picture)).pixels->data<std::uint8_t>()[0];
    }
    TemporaryFolder folder;
};

TEST_F(PlyTextures, ACubeIsItsObjTwin) {
    const Scene obj = load(obj_cube(), "cube.obj");
    const auto expected = triangles_of(obj.meshes.at(0).primitives.at(0));
    ASSERT_EQ(expected.size(), 12u);
    for (const Form form : {Form::kAscii, Form::kBinary}) {
        const Scene ply = load(ply_cube(form, {"textures\\a.png"}), "cube.ply");  // found beside the scene
        ASSERT_EQ(ply.meshes.at(0).primitives.size(), 1u);
        const Primitive& p = ply.meshes[0].primitives[0];
        EXPECT_EQ(triangles_of(p), expected);
        EXPECT_EQ(p.positions.size(), 24u);
        EXPECT_EQ(grey(ply, p), 10);
        EXPECT_EQ(ply.materials.at(0).base_color, (Vec4{1, 1, 1, 1}));
        EXPECT_TRUE(ply.warnings.empty()) << ply.warnings[0];
    }
}

TEST_F(PlyTextures, SeveralPicturesMakeSeveralParts) {
    const Scene ply = load(ply_cube(Form::kAscii, {"a.png", "b.png"}), "cube.ply");
    ASSERT_EQ(ply.meshes.at(0).primitives.size(), 2u);
    std::vector<std::array<Corner, 3>> both;
    for (std::size_t part = 0; part < 2; ++part) {
        const Primitive& p = ply.meshes[0].primitives[part];
        EXPECT_EQ(p.indices.size(), 18u);
        EXPECT_EQ(grey(ply, p), part == 0 ? 10 : 200);
        const auto triangles = triangles_of(p);
        both.insert(both.end(), triangles.begin(), triangles.end());
    }
    std::sort(both.begin(), both.end());
    EXPECT_EQ(both, triangles_of(load(obj_cube(), "cube.obj").meshes.at(0).primitives.at(0)));
}

TEST_F(PlyTextures, WithoutAPictureTheCoordinatesStay) {
    const Scene ply = load(ply_cube(Form::kBinary, {}), "cube.ply");
    EXPECT_EQ(grey(ply, ply.meshes.at(0).primitives.at(0)), -1);
    EXPECT_EQ(ply.meshes[0].primitives[0].texcoords.at(0).size(), 24u);
}

TEST_F(PlyTextures, CoordinatesOfVerticesTakeThePictureToo) {
    const std::string text =
        "ply\nformat ascii 1.0\ncomment TextureFile b.png\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_index\n"
        "end_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
    const Scene ply = load(text, "t.ply");
    EXPECT_EQ(grey(ply, ply.meshes.at(0).primitives.at(0)), 200);
}

TEST_F(PlyTextures, WhatIsWrongIsAWarning) {
    for (const char* name : {"../../etc/passwd", "/dev/zero", "missing.png", "m.mtl"}) {
        const Scene ply = load(ply_cube(Form::kAscii, {name}), "cube.ply");
        EXPECT_EQ(ply.meshes.at(0).primitives.size(), 1u);
        ASSERT_EQ(ply.warnings.size(), 1u) << name;
        EXPECT_NE(ply.warnings[0].find("TextureFile"), std::string::npos) << ply.warnings[0];
    }
    // Texture numbers without a picture, and coordinates that are too few.
    std::string text = ply_cube(Form::kAscii, {"a.png", "b.png"});
    text.replace(text.find("comment TextureFile b.png\n"), 26, "");
    const Scene fewer = load(text, "cube.ply");
    ASSERT_EQ(fewer.meshes.at(0).primitives.size(), 2u);
    EXPECT_EQ(grey(fewer, fewer.meshes[0].primitives[0]), -1);
    EXPECT_EQ(grey(fewer, fewer.meshes[0].primitives[1]), 10);
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
        "2\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 "
        "0\n";
    for (const char* faces : {"3 0 1 2 4 0 0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n", "3 0 1 2 5 0 0 1 0 1\n3 0 1 2 0\n"}) {
        const Scene scene = load(head + faces, "t.ply");
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_NE(scene.warnings[0].find("not two for each corner"), std::string::npos);
        EXPECT_EQ(scene.meshes.at(0).primitives.at(0).indices.size(), 6u);
    }
}

TEST(PlyTextureLimits, SAFE_ManyNamesAreRefused) {
    std::string text = "ply\nformat ascii 1.0\n";
    for (int i = 0; i < 1025; ++i) text += "comment TextureFile a.png\n";
    EXPECT_NE(load_error(text + "element vertex 0\nproperty float x\nend_header\n", "t.ply").find("more than 1024"),
              std::string::npos);
}

}  // namespace
}  // namespace tessera
