// What the picture makes of one triangle: rejected, degenerate, or snapped vertices, orientation, the
// canonical depth plane, the planes of the surface. Scalar, by definition rather than for speed: the reference engines
// draw from it, and every tracing engine recomputes the depth of its hits from it. Picture coordinates in 24.8 fixed
// point, y down.
#pragma once

#include "shading/surface_planes.h"

#include <cstdint>

namespace tessera {

struct SnappedVertex {
    std::int32_t x, y;
};

struct TriangleSetup {
    enum class Kind : std::uint8_t {
        kOutside,     // outside one plane of the view volume
        kDegenerate,  // no area after snapping, or coordinates beyond any use
        kPlain,       // no clipping needed: polygon has 3 vertices
        kClipped,     // clipped at the near plane or the guard band
    };
    Kind kind = Kind::kOutside;
    float orientation = 0;  // +1 counter-clockwise in the picture as a viewer sees it, -1 clockwise
    ClipVertex<float> vertices[3];
    DepthPlane<float> depth{};
    static constexpr int kMostVertices = 8;  // a triangle cut by five planes
    SnappedVertex polygon[kMostVertices];    // convex up to snapping, in the triangle's own direction
    int vertex_count = 0;

    bool visible() const { return kind == Kind::kPlain || kind == Kind::kClipped; }
    // Whether the viewer sees the front of the surface: counter-clockwise, unless the instance mirrors.
    bool front(const InstanceView& instance) const { return orientation * instance.handedness > 0; }
};

// Twice the signed area of three snapped vertices in 1/65536 square pixels, exact. With y down it is
// negative for triangles that a viewer sees counter-clockwise.
inline std::int64_t twice_area(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c) {
    const auto dx1 = static_cast<std::int64_t>(b.x) - a.x, dy1 = static_cast<std::int64_t>(b.y) - a.y;
    const auto dx2 = static_cast<std::int64_t>(c.x) - a.x, dy2 = static_cast<std::int64_t>(c.y) - a.y;
    return dx1 * dy2 - dx2 * dy1;
}

// Sets up triangle `index` of the instance (0-based within its mesh).
void setup_triangle(const InstanceView& instance, std::uint32_t index, const ProjectionView& projection,
                    TriangleSetup& out);

// The attributes of a vertex; zeros where the mesh has none.
Corner<float> fetch_corner(const MeshView& mesh, std::uint32_t vertex);

// Writes the record of the triangle's planes, surface_floats(layout) numbers, for a visible set-up.
void make_surface_record(const InstanceView& instance, std::uint32_t index, const TriangleSetup& setup,
                         const ProjectionView& projection, const SurfaceLayout& layout, float* record);

// The same for one that the rasterizer does not see (no area after snapping), but rays may: everywhere its first
// corner, from the side that the triangle itself shows.
void make_even_record(const InstanceView& instance, std::uint32_t index, const ProjectionView& projection,
                      const SurfaceLayout& layout, float* record);

}  // namespace tessera
