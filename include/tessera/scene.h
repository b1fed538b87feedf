// The scene as data: everything a renderer needs, nothing it computes. Modelled on glTF 2.0, so a
// glTF file maps to it one to one; an embedder builds the same in code by filling the vectors.
// Right-handed, Y up, metres, radians, candela and lux. References are indices into the vectors of
// Scene (kNone: absent). A Scene is a plain value: copy it, move it, share it read-only between
// threads. validate() checks every reference and range; load_scene() returns valid scenes only.
#pragma once

#include <tessera/export.h>
#include <tessera/material.h>
#include <tessera/shape.h>
#include <tessera/types.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// --- meshes ---------------------------------------------------------------------------------

enum class PrimitiveMode : std::uint8_t {
    kPoints,
    kLines,
    kLineLoop,
    kLineStrip,
    kTriangles,
    kTriangleStrip,
    kTriangleFan
};

// Deltas added to the attributes of the same name, weighted; empty where the target has none.
struct MorphTarget {
    std::vector<Vec3> positions, normals, tangents;
};

// An application-specific attribute (glTF: a name that begins with an underscore).
struct CustomAttribute {
    std::string name;
    int components = 1;  // 1 .. 16
    std::vector<float> values;
};

// The material that a primitive takes in one of the scene's variants.
struct VariantMaterial {
    int variant = kNone, material = kNone;
};

// One draw: vertices of one mode and one material. Every non-empty attribute has one entry per
// vertex. Counter-clockwise is front.
struct Primitive {
    PrimitiveMode mode = PrimitiveMode::kTriangles;
    int material = kNone;  // kNone: the default material
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;                 // unit length; empty: flat normals are made
    std::vector<Vec4> tangents;                // xyz unit, w = +-1; empty: made where a normal map needs them
    std::vector<std::vector<Vec2>> texcoords;  // one vector per uv set
    std::vector<std::vector<Vec4>> colors;     // linear RGBA
    std::vector<std::vector<std::array<std::uint16_t, 4>>> joints;
    std::vector<std::vector<Vec4>> weights;  // as many sets as joints
    std::vector<CustomAttribute> custom;
    std::vector<MorphTarget> targets;
    std::vector<std::uint32_t> indices;     // empty: 0, 1, 2, ...
    std::vector<VariantMaterial> variants;  // where they differ from `material`; kNone as variant: the default
    std::optional<Shape> shape;             // what the triangles stand for
    std::string extras;
};

struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    std::vector<float> weights;  // default morph weights
    std::string extras;
};

// --- cameras and lights ---------------------------------------------------------------------

struct Camera {
    enum class Type : std::uint8_t { kPerspective, kOrthographic };
    std::string name;
    Type type = Type::kPerspective;
    float yfov = 0.8f;            // vertical, radians, below pi
    std::optional<float> aspect;  // width / height; unset: that of the picture
    float xmag = 1, ymag = 1;     // orthographic: half width and half height
    float znear = 0.1f;
    std::optional<float> zfar;  // unset (perspective only): infinite
    std::string extras;
};

struct Light {
    using Type = LightType;
    std::string name;
    LightType type = LightType::kPoint;
    Vec3 color{1, 1, 1};
    float intensity = 1;                             // lux for directional, candela for the others
    std::optional<float> range;                      // metres; unset: unlimited
    float inner_cone = 0, outer_cone = 0.78539816f;  // spot, radians from the axis (-Z of the node)
    LightFalloff falloff = LightFalloff::kInverseSquare;
    SpotProfile spot_profile = SpotProfile::kCones;
    std::string extras;
};

// --- nodes, skins, animations ---------------------------------------------------------------

// A placement of a node's mesh relative to the node: translation * rotation * scale.
struct MeshInstance {
    Vec3 translation{0, 0, 0};
    Quat rotation;
    Vec3 scale{1, 1, 1};
};

struct Node {
    std::string name;
    std::vector<int> children;
    // Local placement: the matrix when set, else translation * rotation * scale.
    std::optional<Mat4> matrix;
    Vec3 translation{0, 0, 0};
    Quat rotation;
    Vec3 scale{1, 1, 1};
    int mesh = kNone, camera = kNone, light = kNone, skin = kNone;
    std::vector<float> weights;  // morph weights; empty: those of the mesh
    // Copies of the mesh, in place of the one at the node; a skinned mesh has none.
    std::vector<MeshInstance> instances;
    std::string extras;
};

struct Skin {
    std::string name;
    std::vector<int> joints;         // nodes
    std::vector<Mat4> inverse_bind;  // one per joint, or empty: identity
    int skeleton = kNone;
    std::string extras;
};

enum class Interpolation : std::uint8_t { kStep, kLinear, kCubicSpline };
enum class AnimationPath : std::uint8_t { kTranslation, kRotation, kScale, kWeights };

struct AnimationSampler {
    std::vector<float> times;   // seconds, strictly increasing
    std::vector<float> values;  // key by key; cubic splines: in-tangent, value, out-tangent per key
    Interpolation interpolation = Interpolation::kLinear;
};

struct AnimationChannel {
    int sampler = kNone, node = kNone;
    AnimationPath path = AnimationPath::kTranslation;
};

struct Animation {
    std::string name;
    std::vector<AnimationSampler> samplers;
    std::vector<AnimationChannel> channels;
    std::string extras;
};

// What one scene draws: these nodes and their descendants. A listed node may have a parent, whose
// placement then does not count; none may be listed twice or below another.
struct SceneRoots {
    std::string name;
    std::vector<int> nodes;
    std::string extras;
};

struct Scene {
    std::vector<Node> nodes;
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Sampler> samplers;
    std::vector<Picture> pictures;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    std::vector<Skin> skins;
    std::vector<Animation> animations;
    std::vector<SceneRoots> scenes;
    int active_scene = 0;  // kNone: nothing is drawn

    std::vector<std::string> variants;  // names of sets of materials; choose_variant() takes one

    // Ambient radiance (the textbooks' Ia); unset: what RenderOptions says.
    std::optional<Vec3> ambient;

    std::string generator, copyright, extras;
    std::vector<std::string> extensions_used, extensions_required, extensions_ignored;
    std::vector<std::string> warnings;  // what loading had to say, one line each
};

// Throws kUsage, naming the place ("nodes/3/mesh"), unless every reference is in range, every
// attribute has its length, all numbers are finite and the nodes form a forest.
TESSERA_API void validate(const Scene& scene);
// Gives every primitive the material that it has in the variant; kUsage for one that does not exist.
TESSERA_API void choose_variant(Scene& scene, int variant);
// Bytes held by the vectors and pictures of the scene.
TESSERA_API std::uint64_t memory_bytes(const Scene& scene);

}  // namespace tessera
