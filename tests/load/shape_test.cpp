// TESSERA_shape: the shapes that a file gives to its primitives.
#include "gltf_text.h"

namespace tessera {
namespace {

// A mesh of one primitive with the extension `shape` and `members`, drawn by one node.
std::string with_shape(const std::string& shape, const std::string& members = "\"attributes\":{}",
                       const std::string& more = {}, const std::vector<std::uint8_t>& buffer = {}) {
    return gltf_text(
        "\"extensionsUsed\":[\"TESSERA_shape\"],\"extensionsRequired\":[\"TESSERA_shape\"],"
        "\"materials\":[{},{}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]," +
            more + "\"meshes\":[{\"primitives\":[{" + members + ",\"extensions\":{\"TESSERA_shape\":" + shape + "}}]}]",
        buffer);
}

const Primitive& only_primitive(const Scene& scene) { return scene.meshes.at(0).primitives.at(0); }

void expect_same(const Primitive& a, const Primitive& b) {
    EXPECT_EQ(a.shape, b.shape);
    EXPECT_EQ(a.mode, b.mode);
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.tangents, b.tangents);
    EXPECT_EQ(a.texcoords, b.texcoords);
    EXPECT_EQ(a.indices, b.indices);
}

TEST(GltfShape, IsRead) {
    const std::vector<std::pair<std::string, Shape>> cases = {
        {R"({"type":"sphere"})", {Shape::Type::kSphere, 1, {0, 0}, 96}},
        {R"({"type":"sphere","radius":0.5,"segments":64})", {Shape::Type::kSphere, 0.5f, {0, 0}, 64}},
        {R"({"type":"disc","radius":2,"extras":{"a":1}})", {Shape::Type::kDisc, 2, {0, 0}, 96}},
        {R"({"segments":8.0,"type":"disc"})", {Shape::Type::kDisc, 1, {0, 0}, 8}},
        {R"({"type":"plane","size":[4,3]})", {Shape::Type::kPlane, 1, {4, 3}, 96}},
        {R"({"type":"plane"})", {Shape::Type::kPlane, 1, {0, 0}, 96}},
    };
    for (const auto& [text, shape] : cases) {
        SCOPED_TRACE(text);
        const Scene scene = load_text(with_shape(text, R"("attributes":{},"material":1,"extras":{"name":"x"})"));
        expect_same(only_primitive(scene), shape_primitive(shape));
        EXPECT_EQ(only_primitive(scene).material, 1);
        EXPECT_EQ(only_primitive(scene).extras, R"({"name":"x"})");
        EXPECT_TRUE(scene.warnings.empty());
        EXPECT_TRUE(scene.extensions_ignored.empty());
    }
}

// For programs that do not know the extension.
TEST(GltfShape, TheTrianglesOfTheFileAreNotRead) {
    const std::vector<std::uint8_t> buffer = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::string accessor = R"("bufferViews":[{"buffer":0,"byteLength":36}],)"
                                 R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}],)";
    const std::string members = R"("attributes":{"POSITION":0,"NORMAL":99},"indices":99,"mode":1)";
    const Scene scene = load_text(with_shape(R"({"type":"disc"})", members, accessor, buffer));
    expect_same(only_primitive(scene), shape_primitive({Shape::Type::kDisc, 1, {0, 0}, 96}));
}

TEST(GltfShape, VariantsChooseItsMaterial) {
    const std::string variants = R"("extensions":{"KHR_materials_variants":{"variants":[{"name":"other"}]}},)";
    const std::string shape =
        R"({"type":"sphere"},"KHR_materials_variants":{"mappings":[{"material":1,"variants":[0]}]})";
    Scene scene = load_text(with_shape(shape, R"("attributes":{},"material":0)", variants));
    EXPECT_EQ(only_primitive(scene).material, 0);
    choose_variant(scene, 0);
    EXPECT_EQ(only_primitive(scene).material, 1);
    EXPECT_NO_THROW(validate(scene));
}

TEST(GltfShape, WhatCannotBeIsRefusedByNameAndPlace) {
    const std::string place = "/meshes/0/primitives/0/extensions/TESSERA_shape";
    const std::vector<std::array<std::string, 3>> cases = {
        {R"({})", place, "\"type\" is missing"},
        {R"(7)", place, "object"},
        {R"({"type":"cube"})", place + "/type", "there is no shape \"cube\""},
        {R"({"type":3})", place + "/type", "a string"},
        {R"({"type":"sphere","radius":0})", place + "/radius", "must be finite and above 0"},
        {R"({"type":"disc","radius":-1})", place + "/radius", "must be finite and above 0"},
        {R"({"type":"disc","radius":1e39})", place + "/radius", "too large"},
        {R"({"type":"disc","radius":"1"})", place + "/radius", "a number"},
        {R"({"type":"sphere","segments":7})", place + "/segments", "must be 8 to 1024"},
        {R"({"type":"sphere","segments":1025})", place + "/segments", "must be 8 to 1024"},
        {R"({"type":"sphere","segments":4294967400})", place + "/segments", "too large"},
        {R"({"type":"sphere","segments":-8})", place + "/segments", "non-negative integer"},
        {R"({"type":"sphere","size":[1,1]})", place + "/size", "a sphere has no such member"},
        {R"({"type":"disc","colour":1})", place + "/colour", "a disc has no such member"},
        {R"({"type":"plane","radius":1})", place + "/radius", "a plane has no such member"},
        {R"({"type":"plane","segments":8})", place + "/segments", "a plane has no such member"},
        {R"({"type":"plane","":8})", place + "/", "a plane has no such member"},
        {R"({"type":"plane","size":[1]})", place + "/size", "expected 2 numbers"},
        {R"({"type":"plane","size":[1,0]})", place + "/size", "must be finite and above 0"},
        {R"({"type":"plane","size":[0,0]})", place + "/size", "must be finite and above 0"},
        {R"({"type":"plane","size":[1,-2]})", place + "/size", "must be finite and above 0"},
    };
    for (const auto& [shape, where, reason] : cases) {
        SCOPED_TRACE(shape);
        const std::string error = load_error(with_shape(shape));
        EXPECT_EQ(error.find("test.gltf: " + where + ": "), 0u) << error;
        EXPECT_NE(error.find(reason), std::string::npos) << error;
    }
    const std::string morphed = with_shape(R"({"type":"disc"})", R"("attributes":{},"targets":[{}])");
    EXPECT_EQ(load_error(morphed), "test.gltf: /meshes/0/primitives/0/targets: a shape has no morph targets");
    const std::string material = with_shape(R"({"type":"disc"})", R"("attributes":{},"material":2)");
    EXPECT_NE(load_error(material).find("/material"), std::string::npos);
}

TEST(GltfShape, CountsTowardsTheLimits) {
    const std::string ball = with_shape(R"({"type":"sphere"})");  // 47 bands of quads or twice as many triangles
    LoadOptions options;
    options.max_triangles = 2 * 96 * 47;
    EXPECT_EQ(load_error(ball, options), "");
    --options.max_triangles;
    EXPECT_NE(load_error(ball, options, ErrorCode::kLimit).find("9024 triangles, the limit is 9023"),
              std::string::npos);
    // 525,823 vertices of 48 bytes, which a mesh that nothing draws takes, too.
    std::string undrawn = with_shape(R"({"type":"sphere","segments":1024})");
    undrawn.replace(undrawn.find("\"nodes\":[{\"mesh\":0}]"), 20, "\"nodes\":[{}]");
    options = {};
    options.max_bytes = std::uint64_t{525823} * 48 + std::uint64_t{3} * 4 * 2 * 1024 * 511;
    EXPECT_NE(load_error(undrawn, options, ErrorCode::kLimit).find("/meshes/0/primitives/0: needs"), std::string::npos);
    options.max_bytes += 100000;
    EXPECT_EQ(load_error(undrawn, options), "");
}

// As of every primitive without joints.
TEST(GltfShape, ASkinLeavesItWhereItIs) {
    std::string text = with_shape(R"({"type":"sphere"})", R"("attributes":{})", R"("skins":[{"joints":[0]}],)");
    text.insert(text.find("\"mesh\":0}"), "\"skin\":0,");
    const Scene scene = load_text(text);
    EXPECT_EQ(scene.nodes[0].skin, 0);
    EXPECT_TRUE(only_primitive(scene).shape);
}

TEST(GltfShape, ExtensionsInItAreNamed) {
    const Scene scene = load_text(with_shape(R"({"type":"disc","extensions":{"EXT_ring":{}}})"));
    EXPECT_TRUE(warned(scene, "EXT_ring is ignored"));
}

}  // namespace
}  // namespace tessera
