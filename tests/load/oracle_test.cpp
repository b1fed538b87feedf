// The readers against independent ones (assimp): for every glTF model the same primitives, vertices,
// faces, bounds and material factors; for the other formats the same triangles.
#include "test_files.h"

#include <tessera/error.h>
#include <tessera/load.h>

#include <gtest/gtest.h>

#ifdef TESSERA_HAS_ASSIMP
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tessera {
namespace {

std::uint32_t vertex_of(const Primitive& p, std::size_t i) {
    return p.indices.empty() ? static_cast<std::uint32_t>(i) : p.indices[i];
}

// The faces of a primitive as lists of vertices, as glTF 2.0, section 3.7.2.1 defines them.
std::vector<std::vector<std::uint32_t>> faces_of(const Primitive& p) {
    const std::size_t n = p.indices.empty() ? p.positions.size() : p.indices.size();
    std::vector<std::vector<std::uint32_t>> faces;
    const auto v = [&](std::size_t i) { return vertex_of(p, i); };
    switch (p.mode) {
        case PrimitiveMode::kPoints:
            for (std::size_t i = 0; i < n; ++i) faces.push_back({v(i)});
            break;
        case PrimitiveMode::kLines:
            for (std::size_t i = 0; i + 1 < n; i += 2) faces.push_back({v(i), v(i + 1)});
            break;
        case PrimitiveMode::kLineLoop:
        case PrimitiveMode::kLineStrip:
            for (std::size_t i = 0; i + 1 < n; ++i) faces.push_back({v(i), v(i + 1)});
            if (p.mode == PrimitiveMode::kLineLoop) faces.push_back({v(n - 1), v(0)});
            break;
        case PrimitiveMode::kTriangles:
            for (std::size_t i = 0; i + 2 < n; i += 3) faces.push_back({v(i), v(i + 1), v(i + 2)});
            break;
        case PrimitiveMode::kTriangleStrip:
            for (std::size_t i = 0; i + 2 < n; ++i)
                faces.push_back(i % 2 ? std::vector{v(i + 1), v(i), v(i + 2)} : std::vector{v(i), v(i + 1), v(i + 2)});
            break;
        case PrimitiveMode::kTriangleFan:
            for (std::size_t i = 1; i + 1 < n; ++i) faces.push_back({v(0), v(i), v(i + 1)});
            break;
    }
    return faces;
}

void compare_attributes(const Primitive& ours, const aiMesh& theirs) {
    ASSERT_EQ(ours.positions.size(), theirs.mNumVertices);
    Bounds3 bounds, their_bounds;
    for (unsigned v = 0; v < theirs.mNumVertices; ++v) {
        const aiVector3D& p = theirs.mVertices[v];
        ASSERT_NEAR(ours.positions[v].x, p.x, 1e-6) << "vertex " << v;
        ASSERT_NEAR(ours.positions[v].y, p.y, 1e-6) << "vertex " << v;
        ASSERT_NEAR(ours.positions[v].z, p.z, 1e-6) << "vertex " << v;
        bounds.add(ours.positions[v]);
        their_bounds.add(Vec3{p.x, p.y, p.z});
    }
    EXPECT_EQ(bounds.min, their_bounds.min);
    EXPECT_EQ(bounds.max, their_bounds.max);
    if (!ours.normals.empty()) {
        ASSERT_TRUE(theirs.HasNormals());
        for (unsigned v = 0; v < theirs.mNumVertices; ++v) {
            ASSERT_NEAR(ours.normals[v].x, theirs.mNormals[v].x, 1e-6);
            ASSERT_NEAR(ours.normals[v].y, theirs.mNormals[v].y, 1e-6);
            ASSERT_NEAR(ours.normals[v].z, theirs.mNormals[v].z, 1e-6);
        }
    }
    for (unsigned s = 0; s < ours.texcoords.size() && s < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++s) {
        ASSERT_TRUE(theirs.HasTextureCoords(s));
        for (unsigned v = 0; v < theirs.mNumVertices; ++v) {
            ASSERT_NEAR(ours.texcoords[s][v].x, theirs.mTextureCoords[s][v].x, 1e-6);
            ASSERT_NEAR(ours.texcoords[s][v].y, 1 - theirs.mTextureCoords[s][v].y,
                        1e-6 * std::max(1.0f, std::fabs(ours.texcoords[s][v].y)));  // assimp turns v over
        }
    }
}

// Assimp lists three corners of a face in any rotation; the winding must be the same.
bool same_face(const std::vector<std::uint32_t>& a, const aiFace& b) {
    if (a.size() != b.mNumIndices) return false;
    for (std::size_t shift = 0; shift < a.size(); ++shift) {
        bool same = true;
        for (std::size_t i = 0; i < a.size(); ++i) same = same && a[(i + shift) % a.size()] == b.mIndices[i];
        if (same) return true;
    }
    return false;
}

void compare_faces(const Primitive& ours, const aiMesh& theirs) {
    const std::vector<std::vector<std::uint32_t>> faces = faces_of(ours);
    ASSERT_EQ(faces.size(), theirs.mNumFaces);
    for (std::size_t f = 0; f < faces.size(); ++f) ASSERT_TRUE(same_face(faces[f], theirs.mFaces[f])) << "face " << f;
}

void compare_material(const Material& ours, const aiMaterial& theirs) {
    if (ours.model == ShadingModel::kSpecularGlossiness) return;  // assimp keeps it apart
    aiColor4D color;
    ASSERT_EQ(theirs.Get(AI_MATKEY_BASE_COLOR, color), aiReturn_SUCCESS);
    EXPECT_FLOAT_EQ(ours.base_color.x, color.r);
    EXPECT_FLOAT_EQ(ours.base_color.y, color.g);
    EXPECT_FLOAT_EQ(ours.base_color.z, color.b);
    EXPECT_FLOAT_EQ(ours.base_color.w, color.a);
    float metallic = 0, roughness = 0;
    ASSERT_EQ(theirs.Get(AI_MATKEY_METALLIC_FACTOR, metallic), aiReturn_SUCCESS);
    ASSERT_EQ(theirs.Get(AI_MATKEY_ROUGHNESS_FACTOR, roughness), aiReturn_SUCCESS);
    EXPECT_FLOAT_EQ(ours.metallic, metallic);
    EXPECT_FLOAT_EQ(ours.roughness, roughness);
    aiColor3D emissive;
    ASSERT_EQ(theirs.Get(AI_MATKEY_COLOR_EMISSIVE, emissive), aiReturn_SUCCESS);
    EXPECT_FLOAT_EQ(ours.emissive.x, emissive.r);
    EXPECT_FLOAT_EQ(ours.emissive.y, emissive.g);
    EXPECT_FLOAT_EQ(ours.emissive.z, emissive.b);
    bool two_sided = false;
    if (theirs.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS) {
        EXPECT_EQ(ours.double_sided, two_sided);
    }
}

void compare_node(const Scene& ours, int number, const aiScene& theirs, const aiNode& other) {
    const Node& node = ours.nodes[static_cast<std::size_t>(number)];
    SCOPED_TRACE("node " + std::to_string(number));
    if (node.mesh != kNone) {
        const Mesh& mesh = ours.meshes[static_cast<std::size_t>(node.mesh)];
        ASSERT_EQ(mesh.primitives.size(), other.mNumMeshes);
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            SCOPED_TRACE("primitive " + std::to_string(i));
            const Primitive& p = mesh.primitives[i];
            const aiMesh& their_mesh = *theirs.mMeshes[other.mMeshes[i]];
            compare_attributes(p, their_mesh);
            compare_faces(p, their_mesh);
            if (p.material != kNone)
                compare_material(ours.materials[static_cast<std::size_t>(p.material)],
                                 *theirs.mMaterials[their_mesh.mMaterialIndex]);
        }
    } else {
        EXPECT_EQ(other.mNumMeshes, 0u);
    }
    ASSERT_EQ(node.children.size(), other.mNumChildren);
    for (std::size_t c = 0; c < node.children.size(); ++c)
        compare_node(ours, node.children[c], theirs, *other.mChildren[c]);
}

class Oracle : public testing::TestWithParam<std::string> {};

TEST_P(Oracle, ReadsTheSame) {
    Scene ours;
    LoadOptions options;
    options.load_pictures = false;
    try {
        ours = load_scene(gltf_model(GetParam()).string(), options);
    } catch (const Error& error) {
        GTEST_SKIP() << error.what();
    }
    Assimp::Importer importer;
    const aiScene* theirs = importer.ReadFile(gltf_model(GetParam()).string(), 0);
    if (!theirs) GTEST_SKIP() << "assimp: " << importer.GetErrorString();

    // Assimp numbers meshes and materials in the order of their use, so the nodes lead to them. It
    // adds a root above several.
    ASSERT_NE(ours.active_scene, kNone);
    const std::vector<int>& roots = ours.scenes[static_cast<std::size_t>(ours.active_scene)].nodes;
    if (roots.size() == 1) {
        compare_node(ours, roots[0], *theirs, *theirs->mRootNode);
    } else {
        ASSERT_EQ(roots.size(), theirs->mRootNode->mNumChildren);
        for (std::size_t r = 0; r < roots.size(); ++r)
            compare_node(ours, roots[r], *theirs, *theirs->mRootNode->mChildren[r]);
    }
    EXPECT_EQ(ours.cameras.size(), theirs->mNumCameras);
    EXPECT_EQ(ours.animations.size(), theirs->mNumAnimations);
}

class MeshOracle : public testing::TestWithParam<std::string> {};

// OBJ, PLY and STL: the two readers share vertices and name objects in their own ways, but draw the same.
TEST_P(MeshOracle, DrawsTheSame) {
    const Scene ours = load_scene(GetParam());
    Assimp::Importer importer;
    const aiScene* theirs = importer.ReadFile(GetParam(), aiProcess_Triangulate);
    if (!theirs) GTEST_SKIP() << "assimp: " << importer.GetErrorString();
    std::uint64_t triangles = 0, their_triangles = 0;
    double area = 0, their_area = 0;
    Bounds3 bounds, their_bounds;
    const auto area_of = [](const Vec3& a, const Vec3& b, const Vec3& c) {
        const double e[3] = {double(b.x) - a.x, double(b.y) - a.y, double(b.z) - a.z};
        const double f[3] = {double(c.x) - a.x, double(c.y) - a.y, double(c.z) - a.z};
        const double x = e[1] * f[2] - e[2] * f[1], y = e[2] * f[0] - e[0] * f[2], z = e[0] * f[1] - e[1] * f[0];
        return std::sqrt(x * x + y * y + z * z) / 2;
    };
    for (const Mesh& mesh : ours.meshes)
        for (const Primitive& p : mesh.primitives) {
            if (p.mode != PrimitiveMode::kTriangles) continue;
            for (const std::vector<std::uint32_t>& f : faces_of(p)) {
                ++triangles;
                area += area_of(p.positions[f[0]], p.positions[f[1]], p.positions[f[2]]);
                for (const std::uint32_t v : f) bounds.add(p.positions[v]);
            }
        }
    for (unsigned m = 0; m < theirs->mNumMeshes; ++m) {
        const aiMesh& mesh = *theirs->mMeshes[m];
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            if (mesh.mFaces[f].mNumIndices != 3) continue;
            ++their_triangles;
            Vec3 p[3];
            for (unsigned k = 0; k < 3; ++k) {
                const aiVector3D& v = mesh.mVertices[mesh.mFaces[f].mIndices[k]];
                p[k] = {v.x, v.y, v.z};
                their_bounds.add(p[k]);
            }
            their_area += area_of(p[0], p[1], p[2]);
        }
    }
    EXPECT_EQ(triangles, their_triangles);
    EXPECT_NEAR(area, their_area, 1e-5 * area);
    const double size =
        std::max({bounds.max.x - bounds.min.x, bounds.max.y - bounds.min.y, bounds.max.z - bounds.min.z});
    for (const auto& [a, b] : {std::pair(bounds.min, their_bounds.min), std::pair(bounds.max, their_bounds.max)}) {
        EXPECT_NEAR(a.x, b.x, 1e-6 * size);
        EXPECT_NEAR(a.y, b.y, 1e-6 * size);
        EXPECT_NEAR(a.z, b.z, 1e-6 * size);
    }
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
    std::string name = info.param;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

std::string file_test_name(const testing::TestParamInfo<std::string>& info) {
    return test_name({std::filesystem::path(info.param).filename().string(), info.index});
}

INSTANTIATE_TEST_SUITE_P(Models, MeshOracle, testing::ValuesIn(all_mesh_models()), file_test_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MeshOracle);
INSTANTIATE_TEST_SUITE_P(Models, Oracle, testing::ValuesIn(all_gltf_models()), test_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Oracle);

}  // namespace
}  // namespace tessera
#endif
