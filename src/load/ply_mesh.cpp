#include "load/ply_mesh.h"

#include "load/mesh_scene.h"
#include "load/polygon.h"
#include "scene/vertex_normals.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <tuple>
#include <utility>

namespace tessera {
namespace {

std::uint32_t checked_vertex(const LoadContext& context, std::int64_t number, const PlyMesh& mesh,
                             const std::string& of) {
    if (number < 0 || static_cast<std::uint64_t>(number) >= mesh.positions.size())
        context.fail("vertex " + std::to_string(number) + " of " + std::to_string(mesh.positions.size()), of);
    return static_cast<std::uint32_t>(number);
}

template <class T>
void gather(LoadContext& context, std::vector<T>& values, const std::vector<std::uint32_t>& from) {
    if (values.empty()) return;
    std::vector<T> gathered;
    resize(context, gathered, from.size());
    for (std::size_t i = 0; i < from.size(); ++i) gathered[i] = values[from[i]];
    values = std::move(gathered);
}

// Appends triangles as they come.
class TriangleList {
  public:
    TriangleList(LoadContext& context, const PlyMesh& mesh) : context_(context), wedged_(!mesh.wedges.empty()) {}

    void add(std::uint32_t vertex, std::uint32_t corner) {
        append(context_, triangles_.vertices, vertex);
        if (wedged_) append(context_, triangles_.corners, corner);
    }
    std::size_t count() const { return triangles_.vertices.size() / 3; }
    PlyTriangles take() { return std::move(triangles_); }

  private:
    LoadContext& context_;
    bool wedged_;
    PlyTriangles triangles_;
};

void add_faces(LoadContext& context, const PlyMesh& mesh, TriangleList& triangles) {
    std::vector<std::uint32_t> face, split;
    std::vector<Vec3> polygon;
    std::size_t first = 0, largest = 0;
    for (std::size_t f = 0; f < mesh.sizes.size(); ++f) {
        const std::string place = "face " + std::to_string(f);
        const std::size_t n = mesh.sizes[f];
        if (n > 3) {
            count_triangles(context, triangles.count() + n - 2, place);
            charge_polygon(context, n, largest);
        }
        face.clear(), polygon.clear(), split.clear();
        for (std::size_t k = 0; k < n; ++k) {
            face.push_back(checked_vertex(context, mesh.corners[first + k], mesh, place));
            if (n > 3) polygon.push_back(mesh.positions[face.back()]);
        }
        if (n == 3)
            split = {0, 1, 2};
        else
            triangulate_polygon(polygon, split);
        for (const std::uint32_t corner : split)
            triangles.add(face[corner], static_cast<std::uint32_t>(first + corner));
        count_triangles(context, triangles.count(), place);
        first += n;
    }
}

// Strips, which -1 parts: every second triangle is turned over.
void add_strips(LoadContext& context, const PlyMesh& mesh, TriangleList& triangles) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < mesh.strip.size(); ++i) {
        if (mesh.strip[i] < 0) {
            begin = i + 1;
            continue;
        }
        const std::uint32_t c = checked_vertex(context, mesh.strip[i], mesh, "tristrips");
        if (i < begin + 2) continue;
        const auto a = static_cast<std::uint32_t>(mesh.strip[i - 2]), b = static_cast<std::uint32_t>(mesh.strip[i - 1]);
        const bool turned = (i - begin) % 2 != 0;
        for (const std::uint32_t vertex : {turned ? b : a, turned ? a : b, c})
            triangles.add(vertex, PlyTriangles::kNoCorner);
        count_triangles(context, triangles.count(), "tristrips");
    }
}

Primitive take_attributes(PlyMesh& mesh) {
    Primitive p;
    p.positions = std::move(mesh.positions);
    p.normals = std::move(mesh.normals);
    if (!mesh.colors.empty()) p.colors.push_back(std::move(mesh.colors));
    if (!mesh.texcoords.empty()) p.texcoords.push_back(std::move(mesh.texcoords));
    return p;
}

// The corners of triangles in the order of their pictures, vertices and coordinates: equal ones are neighbours and
// become one vertex.
class WedgeOrder {
  public:
    using Key = std::tuple<int, std::uint32_t, std::uint32_t, std::uint32_t>;

    WedgeOrder(LoadContext& context, const PlyMesh& mesh, const PlyTriangles& triangles, int textures)
        : mesh_(mesh), triangles_(triangles), textures_(textures) {
        resize(context, order_, triangles.vertices.size());
        for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::uint32_t>(i);
        std::sort(order_.begin(), order_.end(),
                  [this](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
    }
    std::size_t size() const { return order_.size(); }
    std::uint32_t operator[](std::size_t i) const { return order_[i]; }

    // A triangle has the picture of its first corner.
    int texture(std::uint32_t i) const {
        const int number = wedge(i - i % 3).texture;
        return number < textures_ ? number : kNone;
    }
    PlyWedge wedge(std::uint32_t i) const {
        const std::uint32_t corner = triangles_.corners[i];
        return corner == PlyTriangles::kNoCorner ? PlyWedge{} : mesh_.wedges[corner];
    }
    Key key(std::uint32_t i) const {
        const Vec2 uv = wedge(i).uv;
        return {texture(i), triangles_.vertices[i], std::bit_cast<std::uint32_t>(uv.x),
                std::bit_cast<std::uint32_t>(uv.y)};
    }

  private:
    const PlyMesh& mesh_;
    const PlyTriangles& triangles_;
    int textures_;
    std::vector<std::uint32_t> order_;
};

template <class T>
void add_from(std::vector<T>& to, const std::vector<T>& from, std::uint32_t vertex) {
    if (!from.empty()) to.push_back(from[vertex]);
}

}  // namespace

PlyTriangles triangulate(LoadContext& context, const PlyMesh& mesh) {
    if (mesh.corners.size() >= PlyTriangles::kNoCorner) context.fail("more corners than 32 bits count");
    TriangleList triangles(context, mesh);
    add_faces(context, mesh, triangles);
    add_strips(context, mesh, triangles);
    return triangles.take();
}

void make_normals(LoadContext& context, PlyMesh& mesh, PlyTriangles& triangles) {
    std::vector<std::uint32_t>& vertices = triangles.vertices;
    context.charge(std::uint64_t{vertices.size()} * (2 * sizeof(std::uint32_t) + sizeof(Vec3)));
    std::size_t count = 0;
    std::vector<std::uint32_t> groups = crease_groups(mesh.positions, vertices, count);
    context.charge(std::uint64_t{count} * (sizeof(Vec3) + 3 * sizeof(double)));
    mesh.normals = angle_weighted_normals(mesh.positions, vertices, groups, count);
    std::vector<std::uint32_t> from(count);
    for (std::size_t i = 0; i < vertices.size(); ++i) from[groups[i]] = vertices[i];
    gather(context, mesh.positions, from);
    gather(context, mesh.colors, from);
    gather(context, mesh.texcoords, from);
    vertices = std::move(groups);
}

void turn_to_normals(const PlyMesh& mesh, PlyTriangles& triangles) {
    for (std::size_t i = 0; i < triangles.vertices.size(); i += 3) {
        std::uint32_t* const t = &triangles.vertices[i];
        if (!is_turned({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]},
                       {mesh.normals[t[0]], mesh.normals[t[1]], mesh.normals[t[2]]}))
            continue;
        std::swap(t[1], t[2]);
        if (!triangles.corners.empty()) std::swap(triangles.corners[i + 1], triangles.corners[i + 2]);
    }
}

std::vector<PlyPart> split_by_texture(LoadContext& context, PlyMesh&& mesh, PlyTriangles&& triangles, int textures) {
    std::vector<PlyPart> parts;
    if (mesh.wedges.empty()) {
        parts.emplace_back();
        parts[0].texture = textures > 0 ? 0 : kNone;
        parts[0].primitive = take_attributes(mesh);
        parts[0].primitive.indices = std::move(triangles.vertices);
        return parts;
    }
    const WedgeOrder order(context, mesh, triangles, textures);
    constexpr std::uint64_t kMostPerCorner = 2 * sizeof(Vec3) + sizeof(Vec4) + sizeof(Vec2) + sizeof(std::uint32_t);
    context.charge(2 * kMostPerCorner * order.size());  // vectors that grow
    std::vector<std::uint32_t> numbers(order.size());   // of the vertices of corners, within their parts
    for (std::size_t at = 0; at < order.size(); ++at) {
        const std::uint32_t i = order[at];
        const bool is_new_part = at == 0 || order.texture(order[at - 1]) != order.texture(i);
        if (is_new_part) {
            parts.emplace_back();
            parts.back().texture = order.texture(i);
            parts.back().primitive.texcoords.emplace_back();
            if (!mesh.colors.empty()) parts.back().primitive.colors.emplace_back();
        }
        Primitive& p = parts.back().primitive;
        if (is_new_part || order.key(order[at - 1]) != order.key(i)) {
            const std::uint32_t vertex = triangles.vertices[i];
            add_from(p.positions, mesh.positions, vertex);
            add_from(p.normals, mesh.normals, vertex);
            if (!mesh.colors.empty()) add_from(p.colors[0], mesh.colors, vertex);
            p.texcoords[0].push_back(order.wedge(i).uv);
        }
        numbers[i] = static_cast<std::uint32_t>(p.positions.size() - 1);
    }
    // The triangles stay in their order.
    std::vector<std::size_t> part_of(static_cast<std::size_t>(textures) + 1);
    for (std::size_t part = 0; part < parts.size(); ++part)
        part_of[static_cast<std::size_t>(parts[part].texture + 1)] = part;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const int texture = order.texture(static_cast<std::uint32_t>(i));
        parts[part_of[static_cast<std::size_t>(texture + 1)]].primitive.indices.push_back(numbers[i]);
    }
    return parts;
}

std::vector<PlyPart> lines_or_points(LoadContext& context, PlyMesh&& mesh) {
    std::vector<PlyPart> parts;
    if (mesh.positions.empty()) return parts;
    std::vector<std::uint32_t> ends;
    for (const std::int64_t end : mesh.edges) append(context, ends, checked_vertex(context, end, mesh, "edges"));
    Primitive p = take_attributes(mesh);
    p.mode = ends.empty() ? PrimitiveMode::kPoints : PrimitiveMode::kLines;
    p.indices = std::move(ends);
    parts.push_back({kNone, std::move(p)});
    return parts;
}

}  // namespace tessera
