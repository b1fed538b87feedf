// Real models load, and the twins of a model (external, embedded, GLB) give equal scenes.
#include "test_files.h"

#include <tessera/error.h>
#include <tessera/load.h>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Models, EveryModelLoadsAndIsValid) {
    const std::vector<std::string> names = all_gltf_models();
    if (names.empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    for (const std::string& name : names) {
        SCOPED_TRACE(name);
        const Scene scene = load_scene(gltf_model(name).string());
        EXPECT_NO_THROW(validate(scene));
        EXPECT_GT(memory_bytes(scene), sizeof(Scene));
    }
}

void expect_twins(const std::string& a_name, const std::string& b_name) {
    SCOPED_TRACE(a_name + " and " + b_name);
    const Scene a = load_scene(gltf_model(a_name).string()), b = load_scene(gltf_model(b_name).string());
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (std::size_t m = 0; m < a.meshes.size(); ++m) {
        ASSERT_EQ(a.meshes[m].primitives.size(), b.meshes[m].primitives.size());
        for (std::size_t p = 0; p < a.meshes[m].primitives.size(); ++p) {
            const Primitive &x = a.meshes[m].primitives[p], &y = b.meshes[m].primitives[p];
            EXPECT_EQ(x.mode, y.mode);
            EXPECT_EQ(x.material, y.material);
            EXPECT_FALSE(x.positions.empty());
            EXPECT_EQ(x.positions, y.positions);
            EXPECT_EQ(x.normals, y.normals);
            EXPECT_EQ(x.tangents, y.tangents);
            EXPECT_EQ(x.texcoords, y.texcoords);
            EXPECT_EQ(x.joints, y.joints);
            EXPECT_EQ(x.weights, y.weights);
            EXPECT_EQ(x.indices, y.indices);
        }
    }
    for (std::size_t n = 0; n < a.nodes.size(); ++n) {
        EXPECT_EQ(a.nodes[n].matrix, b.nodes[n].matrix);
        EXPECT_EQ(a.nodes[n].translation, b.nodes[n].translation);
        EXPECT_EQ(a.nodes[n].rotation, b.nodes[n].rotation);
        EXPECT_EQ(a.nodes[n].scale, b.nodes[n].scale);
        EXPECT_EQ(a.nodes[n].children, b.nodes[n].children);
    }
}

TEST(Models, TwinsAreEqual) {
    if (all_gltf_models().empty()) GTEST_SKIP() << "no models: set TESSERA_MODELS";
    expect_twins("Box/glTF/Box.gltf", "Box/glTF-Binary/Box.glb");
    expect_twins("Box/glTF/Box.gltf", "Box/glTF-Embedded/Box.gltf");
    expect_twins("BoxAnimated/glTF/BoxAnimated.gltf", "BoxAnimated/glTF-Binary/BoxAnimated.glb");
    expect_twins("BoxAnimated/glTF/BoxAnimated.gltf", "BoxAnimated/glTF-Embedded/BoxAnimated.gltf");
    expect_twins("AnimatedMorphCube/glTF/AnimatedMorphCube.gltf",
                 "AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb");
    expect_twins("RiggedSimple/glTF/RiggedSimple.gltf", "RiggedSimple/glTF-Binary/RiggedSimple.glb");
    expect_twins("RiggedSimple/glTF/RiggedSimple.gltf", "RiggedSimple/glTF-Embedded/RiggedSimple.gltf");
    expect_twins("TextureSettingsTest/glTF/TextureSettingsTest.gltf",
                 "TextureSettingsTest/glTF-Binary/TextureSettingsTest.glb");
    expect_twins("SimpleMorph/glTF/SimpleMorph.gltf", "SimpleMorph/glTF-Embedded/SimpleMorph.gltf");
    expect_twins("SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf",
                 "SimpleSparseAccessor/glTF-Embedded/SimpleSparseAccessor.gltf");
    expect_twins("Triangle/glTF/Triangle.gltf", "Triangle/glTF-Embedded/Triangle.gltf");
    expect_twins("TriangleWithoutIndices/glTF/TriangleWithoutIndices.gltf",
                 "TriangleWithoutIndices/glTF-Embedded/TriangleWithoutIndices.gltf");
}

}  // namespace
}  // namespace tessera
