// Meshes: primitives with their vertex attributes, indices and morph targets.
#include "load/gltf_accessor.h"
#include "load/gltf_draco.h"
#include "load/gltf_parts.h"
#include "load/gltf_shape.h"
#include "scene/counts.h"
#include "scene/numbers.h"
#include "scene/shapes.h"

#include <algorithm>
#include <charconv>

namespace tessera {
namespace {

// "TEXCOORD_1" is set 1 of TEXCOORD. Names without a number of this form have set kNoSet.
constexpr std::size_t kMaxSets = 16, kNoSet = kMaxSets;
struct AttributeName {
    std::string_view base;
    std::size_t set = kNoSet;
};

AttributeName parse_name(std::string_view name) {
    const std::size_t underscore = name.rfind('_');
    if (underscore == std::string_view::npos || underscore == 0) return {name, kNoSet};
    const std::string_view digits = name.substr(underscore + 1);
    std::size_t set = kNoSet;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), set);
    if (error != std::errc() || end != digits.data() + digits.size() || set >= kMaxSets) return {name, kNoSet};
    return {name.substr(0, underscore), set};
}

// A primitive on its way: what Draco packed of it, if anything.
struct PrimitiveSource {
    GltfDocument& document;
    std::optional<DracoPrimitive> draco = std::nullopt;
};

// The indices of a primitive, among its attributes' names.
constexpr std::string_view kIndices = {};

// Opens the accessor that `json`, the attribute of that name, refers to and checks it, with its number of
// elements unless 0.
Accessor attribute(PrimitiveSource& source, std::string_view name, const Json& json, std::string_view type,
                   unsigned formats, std::size_t vertices) {
    const int number = json.reference(source.document.size(GltfArray::kAccessors), "accessor");
    Accessor accessor = open_accessor(source.document, static_cast<std::size_t>(number),
                                      source.draco ? Zeros::kToBeReplaced : Zeros::kLimited);
    expect_format(json, accessor, type, formats);
    if (source.draco) {
        name == kIndices ? source.draco->supply_indices(accessor) : source.draco->supply(name, accessor);
        check_zeros(accessor);
    }
    if (vertices != 0 && accessor.count != vertices)
        json.fail(std::to_string(accessor.count) + " elements, POSITION has " + std::to_string(vertices));
    return accessor;
}

template <class T>
std::vector<T>& set_of(std::vector<std::vector<T>>& sets, std::size_t set) {
    if (sets.size() <= set) sets.resize(set + 1);
    return sets[set];
}

std::vector<Vec4> read_colors(GltfDocument& document, const Accessor& accessor) {
    if (accessor.components() == 4) return read_floats<Vec4>(document, accessor);
    const std::vector<Vec3> rgb = read_floats<Vec3>(document, accessor);
    document.context().charge(std::uint64_t{rgb.size()} * sizeof(Vec4), accessor.json.place());
    std::vector<Vec4> rgba(rgb.size());
    std::transform(rgb.begin(), rgb.end(), rgba.begin(), [](Vec3 c) { return Vec4{c.x, c.y, c.z, 1}; });
    return rgba;
}

void read_attribute(PrimitiveSource& source, std::string_view name, const Json& json, Primitive& p) {
    GltfDocument& document = source.document;
    const std::size_t n = p.positions.size();
    const AttributeName parsed = parse_name(name);
    if (name == "POSITION") return;
    if (name == "NORMAL") {
        p.normals = read_floats<Vec3>(document, attribute(source, name, json, "VEC3", kFloats | kNormalizedSigned, n));
    } else if (name == "TANGENT") {
        p.tangents = read_floats<Vec4>(document, attribute(source, name, json, "VEC4", kFloats | kNormalizedSigned, n));
    } else if (parsed.base == "TEXCOORD" && parsed.set != kNoSet) {
        set_of(p.texcoords, parsed.set) =
            read_floats<Vec2>(document, attribute(source, name, json, "VEC2", kQuantized, n));
    } else if (parsed.base == "COLOR" && parsed.set != kNoSet) {
        const Accessor colors = attribute(source, name, json, "", kFloats | kNormalizedUnsigned, n);
        if (colors.type != "VEC3") expect_format(json, colors, "VEC4", kFloats | kNormalizedUnsigned);
        set_of(p.colors, parsed.set) = read_colors(document, colors);
    } else if (parsed.base == "JOINTS" && parsed.set != kNoSet) {
        set_of(p.joints, parsed.set) = read_joints(document, attribute(source, name, json, "VEC4", kPlainUnsigned, n));
    } else if (parsed.base == "WEIGHTS" && parsed.set != kNoSet) {
        set_of(p.weights, parsed.set) =
            read_floats<Vec4>(document, attribute(source, name, json, "VEC4", kFloats | kNormalizedUnsigned, n));
    } else if (name.starts_with('_')) {
        const Accessor values = attribute(source, name, json, "", kQuantized | kUnsignedInts, n);
        p.custom.push_back(
            {std::string(name), static_cast<int>(values.components()), read_floats<float>(document, values)});
    } else {
        document.context().warn(json.place() + ": the attribute is ignored");
    }
}

// Skins need joints and weights in pairs; joint numbers of weight zero mean nothing and may be garbage.
void pair_joints_and_weights(LoadContext& context, const Json& attributes, Primitive& p) {
    const std::size_t sets = std::max(p.joints.size(), p.weights.size());
    p.joints.resize(sets);
    p.weights.resize(sets);
    for (std::size_t s = 0; s < sets; ++s) {
        if (p.joints[s].size() != p.weights[s].size()) {
            context.warn(attributes.place() + ": joints and weights " + std::to_string(s) +
                         " are ignored, one is missing");
            p.joints[s].clear();
            p.weights[s].clear();
        }
        for (std::size_t v = 0; v < p.joints[s].size(); ++v) {
            const Vec4& w = p.weights[s][v];
            std::array<std::uint16_t, 4>& joints = p.joints[s][v];
            if (w.x == 0) joints[0] = 0;
            if (w.y == 0) joints[1] = 0;
            if (w.z == 0) joints[2] = 0;
            if (w.w == 0) joints[3] = 0;
        }
    }
}

MorphTarget read_target(GltfDocument& document, const Json& json, std::size_t vertices) {
    PrimitiveSource source{document};
    MorphTarget target;
    json.each_member([&](std::string_view name, const Json& value) {
        if (name != "POSITION" && name != "NORMAL" && name != "TANGENT") {
            document.context().warn(value.place() + ": the morph target's attribute is ignored");
            return;
        }
        const Accessor accessor = attribute(source, name, value, "VEC3", kQuantized, vertices);
        std::vector<Vec3>& deltas = name == "POSITION" ? target.positions
                                    : name == "NORMAL" ? target.normals
                                                       : target.tangents;
        deltas = read_floats<Vec3>(document, accessor);
    });
    return target;
}

void read_primitive_indices(PrimitiveSource& source, const Json& json, Primitive& p) {
    p.indices =
        read_indices(source.document, attribute(source, kIndices, json, "SCALAR", kPlainUnsigned | kUnsignedInts, 0));
    const std::uint32_t largest = largest_index(p.indices);
    if (largest >= p.positions.size())
        json.fail("index " + std::to_string(largest) + " of " + std::to_string(p.positions.size()) + " vertices");
}

PrimitiveMode read_mode(const Json& json) {
    const std::optional<Json> mode = json.find("mode");
    if (!mode) return PrimitiveMode::kTriangles;
    return static_cast<PrimitiveMode>(mode->integer(6));  // glTF numbers them as PrimitiveMode does
}

// KHR_materials_variants: materials, and the variants of the scene that take them.
void read_variants(GltfDocument& document, const Json& json, Primitive& p) {
    json.at("mappings").each([&](const Json& mapping, std::size_t) {
        const int material = mapping.at("material").reference(document.size(GltfArray::kMaterials), "material");
        mapping.at("variants").each([&](const Json& variant, std::size_t) {
            document.context().charge(sizeof(VariantMaterial), variant.place());
            p.variants.push_back({variant.reference(document.variant_count(), "variant"), material});
        });
    });
}

// What a packed primitive may be: triangles or a strip of them, with indices. Draco unpacks both to a list.
DracoTriangles packed_triangles(const GltfDocument& document, const Json& json, PrimitiveMode& mode) {
    if (mode != PrimitiveMode::kTriangles && mode != PrimitiveMode::kTriangleStrip)
        json.fail("only triangles and strips of them are packed by Draco");
    const int indices = json.at("indices").reference(document.size(GltfArray::kAccessors), "accessor");
    const std::uint64_t count = accessor_count(document, static_cast<std::size_t>(indices));
    const bool strip = mode == PrimitiveMode::kTriangleStrip;
    const std::uint64_t triangles = triangle_count(mode, count);
    mode = PrimitiveMode::kTriangles;
    return {static_cast<std::size_t>(triangles), strip};
}

// Vertices, indices and morph targets, into a primitive without any.
void read_vertices(GltfDocument& document, const Json& json, Primitive& p) {
    LoadContext& context = document.context();
    p.mode = read_mode(json);
    const Json attributes = json.at("attributes");
    const std::optional<Json> positions = attributes.find("POSITION");
    if (!positions) {
        context.warn(attributes.place() + ": a primitive without positions is not drawn");
        return;
    }
    PrimitiveSource source{document};
    if (const std::optional<Json> packed = find_extension(json, "KHR_draco_mesh_compression"))
        source.draco.emplace(document, *packed, packed_triangles(document, json, p.mode));
    p.positions = read_floats<Vec3>(document, attribute(source, "POSITION", *positions, "VEC3", kQuantized, 0));
    attributes.each_member([&](std::string_view name, const Json& value) { read_attribute(source, name, value, p); });
    if (p.normals.empty()) p.tangents.clear();  // section 3.7.2.1: then tangents must be ignored
    pair_joints_and_weights(context, attributes, p);
    if (const std::optional<Json> targets = json.find("targets"))
        targets->each([&](const Json& target, std::size_t) {
            context.charge(sizeof(MorphTarget), target.place());
            p.targets.push_back(read_target(document, target, p.positions.size()));
        });
    if (const std::optional<Json> indices = json.find("indices")) read_primitive_indices(source, *indices, p);
}

Primitive read_primitive(GltfDocument& document, const Json& json) {
    document.context().charge(sizeof(Primitive), json.place());
    document.note_extensions(json);
    const std::optional<Shape> shape = find_shape(json);
    Primitive p = shape ? read_shape_primitive(document, json, *shape) : Primitive{};
    p.extras = json.raw_or_empty("extras");
    p.material = json.reference_or_none("material", document.size(GltfArray::kMaterials), "material");
    if (!shape) read_vertices(document, json, p);
    if (const std::optional<Json> variants = find_extension(json, "KHR_materials_variants"))
        read_variants(document, *variants, p);
    return p;
}

// Sums stop growing far beyond any limit and so never wrap.
std::uint64_t saturating_sum(std::uint64_t a, std::uint64_t b) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
    return std::min(std::min(a, kMost) + std::min(b, kMost), kMost);
}

// Of a mesh without instances there is one.
std::uint64_t saturating_product(std::uint64_t triangles, std::uint64_t instances) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 62;
    if (instances == 0 || triangles == 0) return std::min(triangles, kMost);
    return triangles > kMost / instances ? kMost : triangles * instances;
}

std::uint64_t count_triangles(const GltfDocument& document, const Json& mesh) {
    std::uint64_t sum = 0;
    mesh.at("primitives").each([&](const Json& json, std::size_t) {
        if (const std::optional<Shape> shape = find_shape(json)) {
            sum = saturating_sum(sum, shape_counts(*shape).triangles);
            return;
        }
        std::optional<Json> counted = json.at("attributes").find("POSITION");
        if (!counted) return;
        if (const std::optional<Json> indices = json.find("indices")) counted = indices;
        const int accessor = counted->reference(document.size(GltfArray::kAccessors), "accessor");
        sum = saturating_sum(
            sum, element_count(read_mode(json), accessor_count(document, static_cast<std::size_t>(accessor))));
    });
    return sum;
}

}  // namespace

void check_triangle_limit(GltfDocument& document, const Scene& scene) {
    std::vector<std::uint64_t> of_mesh(scene.meshes.size());
    document.each(GltfArray::kMeshes,
                  [&](const Json& json, std::size_t i) { of_mesh[i] = count_triangles(document, json); });
    // Parents come before their children in `order`; backwards, each subtree is summed into its root.
    std::vector<std::uint64_t> of_node(scene.nodes.size());
    std::vector<std::size_t> order;
    std::vector<char> is_child(scene.nodes.size(), 0);
    for (const Node& node : scene.nodes)
        for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = 1;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i)
        if (!is_child[i]) order.push_back(i);
    for (std::size_t i = 0; i < order.size(); ++i)
        for (const int child : scene.nodes[order[i]].children) order.push_back(static_cast<std::size_t>(child));
    for (auto i = order.rbegin(); i != order.rend(); ++i) {
        const Node& node = scene.nodes[*i];
        if (node.mesh != kNone)
            of_node[*i] = saturating_product(of_mesh[static_cast<std::size_t>(node.mesh)], node.instances.size());
        for (const int child : node.children)
            of_node[*i] = saturating_sum(of_node[*i], of_node[static_cast<std::size_t>(child)]);
    }
    const std::uint64_t most = document.context().options().max_triangles;
    for (std::size_t s = 0; s < scene.scenes.size(); ++s) {
        std::uint64_t sum = 0;
        for (const int root : scene.scenes[s].nodes) sum = saturating_sum(sum, of_node[static_cast<std::size_t>(root)]);
        if (sum > most)
            document.item(GltfArray::kScenes, s)
                .fail(std::to_string(sum) + " triangles, the limit is " + std::to_string(most), ErrorCode::kLimit);
    }
}

void read_meshes(GltfDocument& document, Scene& scene) {
    document.each(GltfArray::kMeshes, [&](const Json& json, std::size_t i) {
        Mesh& mesh = scene.meshes[i];
        document.note_extensions(json);
        mesh.name = json.string_or("name");
        mesh.extras = json.raw_or_empty("extras");
        if (const std::optional<Json> weights = json.find("weights")) mesh.weights = weights->numbers();
        json.at("primitives").each([&](const Json& primitive, std::size_t) {
            mesh.primitives.push_back(read_primitive(document, primitive));
        });
    });
}

}  // namespace tessera
