#include "load/obj.h"

#include "load/mesh_scene.h"
#include "load/obj_materials.h"
#include "load/obj_text.h"
#include "load/polygon.h"
#include "load/texcoord_check.h"
#include "scene/vertex_normals.h"

#include <algorithm>
#include <span>
#include <utility>

namespace tessera {
namespace {

constexpr std::uint32_t kNothing = 0xffffffff;

std::size_t at(std::int32_t number) { return static_cast<std::size_t>(number); }

// Numbers for a position together with two more numbers, in the order in which they come up: a table with open
// addresses, twice as large as what is in it.
class Numbering {
  public:
    explicit Numbering(LoadContext& context) : context_(context) { grow(64); }

    // The number of (position, a, b), and whether it is new.
    std::pair<std::uint32_t, bool> insert(std::int32_t position, std::int64_t a, std::int64_t b) {
        if (2 * (entries_.size() + 1) > slots_.size()) grow(2 * slots_.size());
        const Entry entry{a, b, position};
        std::uint32_t& slot = slot_of(entry);
        if (slot != kNothing) return {slot, false};
        slot = static_cast<std::uint32_t>(entries_.size());
        append(context_, entries_, entry);
        return {static_cast<std::uint32_t>(entries_.size() - 1), true};
    }
    std::size_t size() const { return entries_.size(); }
    // Forgets all, at the cost of what is in it.
    void clear() {
        for (auto e = entries_.rbegin(); e != entries_.rend(); ++e) slot_of(*e) = kNothing;
        entries_.clear();
    }

  private:
    struct Entry {
        std::int64_t a, b;
        std::int32_t position;
        bool operator==(const Entry&) const = default;
    };
    // Where the entry is, or would be. Taken out from the last one in to the first, none is in another's way.
    std::uint32_t& slot_of(const Entry& e) {
        std::uint64_t hash = static_cast<std::uint64_t>(e.position) * 0x9e3779b97f4a7c15u;
        hash = (hash ^ hash >> 29 ^ static_cast<std::uint64_t>(e.a)) * 0xbf58476d1ce4e5b9u;
        hash = (hash ^ hash >> 32 ^ static_cast<std::uint64_t>(e.b)) * 0x94d049bb133111ebu;
        std::size_t at = (hash ^ hash >> 31) & (slots_.size() - 1);
        while (slots_[at] != kNothing && !(entries_[slots_[at]] == e)) at = (at + 1) & (slots_.size() - 1);
        return slots_[at];
    }
    void grow(std::size_t slots) {
        context_.charge(std::uint64_t{slots} * sizeof(std::uint32_t));
        slots_.assign(slots, kNothing);
        for (std::uint32_t i = 0; i < entries_.size(); ++i) slot_of(entries_[i]) = i;
    }

    LoadContext& context_;
    std::vector<std::uint32_t> slots_;  // as many as a power of two
    std::vector<Entry> entries_;
};

class ObjBuilder {
  public:
    ObjBuilder(LoadContext& context, ObjText&& text, Scene& scene, const std::vector<int>& materials)
        : context_(context), text_(std::move(text)), scene_(scene), materials_(materials) {
        for (Vec3& n : text_.normals) n = unit_normal(n);
    }

    void build() {
        make_normals();
        sort_elements();
        Numbering vertices(context_);
        std::vector<Mesh> meshes(text_.objects.size());
        for (std::size_t i = 0; i < meshes.size(); ++i) meshes[i].name = text_.objects[i];
        for (std::uint32_t part = 0; part < text_.parts.size(); ++part) {
            if (text_.parts[part].elements == 0) continue;
            context_.charge(sizeof(Primitive));
            meshes[text_.parts[part].object].primitives.push_back(primitive(part, vertices));
            vertices.clear();
        }
        for (Mesh& mesh : meshes)
            if (!mesh.primitives.empty()) add_mesh(context_, scene_, std::move(mesh));
    }

  private:
    // Whether it is a face of which the file leaves out some normals; then all are made.
    bool needs_normals(const ObjElement& e) const {
        if (text_.parts[e.part].mode != PrimitiveMode::kTriangles) return false;
        for (std::uint32_t c = 0; c < e.corner_count; ++c)
            if (text_.corners[e.first_corner + c].normal < 0) return true;
        return false;
    }

    // The corners of an element's triangles, numbers into text_.corners, to `triangles_`.
    void split(const ObjElement& e) {
        triangles_.clear();
        polygon_.clear();
        charge_polygon(context_, e.corner_count, largest_);
        for (std::uint32_t c = 0; c < e.corner_count; ++c)
            polygon_.push_back(text_.positions[at(text_.corners[e.first_corner + c].position)]);
        triangulate_polygon(polygon_, triangles_);
        for (std::uint32_t& corner : triangles_) corner += e.first_corner;
    }

    void make_normals() {
        make_grouped_normals();
        make_creased_normals();
    }

    // Where the file says what is smooth.
    void make_grouped_normals() {
        Numbering groups(context_);
        std::vector<std::uint32_t> corners, normals;
        std::uint32_t flat = 0;
        const auto base = static_cast<std::int32_t>(text_.normals.size());
        for (const ObjElement& e : text_.elements) {
            if (!needs_normals(e) || e.smoothing == kUnsaid) continue;
            // Each flat face is a group of its own.
            const std::int64_t group = e.smoothing != 0 ? std::int64_t{e.smoothing} : -1 - std::int64_t{flat++};
            for (std::uint32_t c = 0; c < e.corner_count; ++c) {
                ObjCorner& corner = text_.corners[e.first_corner + c];
                corner.normal = base + static_cast<std::int32_t>(groups.insert(corner.position, group, 0).first);
            }
            split(e);
            for (const std::uint32_t c : triangles_) {
                append(context_, corners, static_cast<std::uint32_t>(text_.corners[c].position));
                append(context_, normals, static_cast<std::uint32_t>(text_.corners[c].normal - base));
            }
        }
        add_normals(corners, normals, groups.size());
    }

    // Where it does not.
    void make_creased_normals() {
        std::vector<std::uint32_t> corners, positions;
        for (const ObjElement& e : text_.elements) {
            if (!needs_normals(e) || e.smoothing != kUnsaid) continue;
            split(e);
            for (const std::uint32_t c : triangles_) {
                append(context_, corners, c);
                append(context_, positions, static_cast<std::uint32_t>(text_.corners[c].position));
            }
        }
        if (corners.empty()) return;
        context_.charge(std::uint64_t{corners.size()} * (2 * sizeof(std::uint32_t) + sizeof(Vec3)));
        std::size_t count = 0;
        const std::vector<std::uint32_t> groups = crease_groups(text_.positions, positions, count);
        const auto base = static_cast<std::int32_t>(text_.normals.size());
        for (std::size_t i = 0; i < corners.size(); ++i)
            text_.corners[corners[i]].normal = base + static_cast<std::int32_t>(groups[i]);
        add_normals(positions, groups, count);
        // Corners of faces that are no triangle at all.
        for (ObjCorner& corner : text_.corners)
            if (corner.normal < 0) corner.normal = base;
    }

    void add_normals(std::span<const std::uint32_t> positions, std::span<const std::uint32_t> groups,
                     std::size_t count) {
        context_.charge(std::uint64_t{count} * (2 * sizeof(Vec3) + 3 * sizeof(double)));
        const std::vector<Vec3> made = angle_weighted_normals(text_.positions, positions, groups, count);
        text_.normals.insert(text_.normals.end(), made.begin(), made.end());
    }

    // Elements of each part together, in the order of the file.
    void sort_elements() {
        context_.charge(std::uint64_t{text_.elements.size()} * sizeof(ObjElement));
        std::stable_sort(text_.elements.begin(), text_.elements.end(),
                         [](const ObjElement& a, const ObjElement& b) { return a.part < b.part; });
        first_element_.assign(text_.parts.size() + 1, 0);
        for (const ObjElement& e : text_.elements) ++first_element_[e.part + 1];
        for (std::size_t i = 1; i < first_element_.size(); ++i) first_element_[i] += first_element_[i - 1];
    }

    Primitive primitive(std::uint32_t part, Numbering& vertices) {
        Primitive p;
        p.mode = text_.parts[part].mode;
        const std::int32_t material = text_.parts[part].material;
        p.material = materials_[static_cast<std::size_t>(material + 1)];
        const bool surface = p.mode == PrimitiveMode::kTriangles;
        if (!surface && material < 0) p.material = kNone;  // the ink that is seen on any background
        bool textured = false;
        for (std::size_t i = first_element_[part]; i < first_element_[part + 1]; ++i)
            for (std::uint32_t c = 0; c < text_.elements[i].corner_count; ++c)
                textured = textured || text_.corners[text_.elements[i].first_corner + c].texcoord >= 0;
        if (textured) p.texcoords.resize(1);
        if (!text_.colors.empty()) p.colors.resize(1);

        const auto vertex = [&](std::uint32_t number) {
            const ObjCorner& corner = text_.corners[number];
            const auto [v, is_new] =
                vertices.insert(corner.position, textured ? corner.texcoord : -1, surface ? corner.normal : -1);
            if (!is_new) return v;
            append(context_, p.positions, text_.positions[at(corner.position)]);
            if (surface) append(context_, p.normals, text_.normals[at(corner.normal)]);
            if (textured)
                append(context_, p.texcoords[0],
                       corner.texcoord >= 0 ? text_.texcoords[at(corner.texcoord)] : Vec2{0, 0});
            if (!text_.colors.empty()) append(context_, p.colors[0], text_.colors[at(corner.position)]);
            return v;
        };
        for (std::size_t i = first_element_[part]; i < first_element_[part + 1]; ++i) {
            const ObjElement& e = text_.elements[i];
            if (surface) {
                split(e);
                for (std::size_t t = 0; t + 2 < triangles_.size(); t += 3) add_triangle(p, &triangles_[t], vertex);
            } else {
                const std::uint32_t count = e.corner_count;
                for (std::uint32_t c = 0; c < count; ++c) {
                    if (p.mode == PrimitiveMode::kLines && c + 1 == count) break;
                    append(context_, p.indices, vertex(e.first_corner + c));
                    if (p.mode == PrimitiveMode::kLines) append(context_, p.indices, vertex(e.first_corner + c + 1));
                }
            }
        }
        return p;
    }
    template <class Vertex>
    void add_triangle(Primitive& p, const std::uint32_t* corners, Vertex&& vertex) {
        std::uint32_t v[3];
        for (int k = 0; k < 3; ++k) v[k] = vertex(corners[k]);
        if (is_turned({p.positions[v[0]], p.positions[v[1]], p.positions[v[2]]},
                      {p.normals[v[0]], p.normals[v[1]], p.normals[v[2]]}))
            std::swap(v[1], v[2]);
        for (const std::uint32_t number : v) append(context_, p.indices, number);
    }

    LoadContext& context_;
    ObjText text_;
    Scene& scene_;
    const std::vector<int>& materials_;  // of the scene, by those of the text + 1
    std::vector<std::uint32_t> triangles_;
    std::vector<Vec3> polygon_;
    std::size_t largest_ = 0;                 // polygon so far
    std::vector<std::size_t> first_element_;  // by part
};

}  // namespace

Scene read_obj(LoadContext& context, std::string_view text, const SceneFiles& files) {
    Scene scene;
    ObjText parsed = read_obj_text(context, text);
    ObjMaterials materials(context, files, scene);
    for (const std::string& library : parsed.libraries) materials.read_libraries(library);
    std::vector<char> used(parsed.materials.size() + 1, 0);
    for (const ObjPart& part : parsed.parts) used[at(part.material + 1)] = 1;
    std::vector<int> numbers(used.size(), kNone);
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) numbers[i] = i == 0 ? materials.plain() : materials.find(parsed.materials[i - 1]);
    materials.finish();
    ObjBuilder(context, std::move(parsed), scene, numbers).build();
    warn_of_missing_texcoords(context, scene);
    finish_scene(context, scene);
    return scene;
}

}  // namespace tessera
