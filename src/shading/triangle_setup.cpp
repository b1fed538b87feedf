#include "shading/triangle_setup.h"

#include "geometry/clip.h"

#include <cmath>
#include <utility>

namespace tessera {
namespace {

bool usable(const ClipVertex<float>& v) {
    return std::fabs(v.x) < kLargestCoordinate && std::fabs(v.y) < kLargestCoordinate &&
           std::fabs(v.z) < kLargestCoordinate && std::fabs(v.w) < kLargestCoordinate;
}

SnappedVertex snap_point(const HomogeneousPoint& p, const ProjectionView& projection) {
    const double half_w = 0.5 * static_cast<double>(projection.width),
                 half_h = 0.5 * static_cast<double>(projection.height);
    const double px = p.x / p.w * half_w + half_w, py = half_h - p.y / p.w * half_h;
    return {static_cast<std::int32_t>(round_even(px * 256.0)), static_cast<std::int32_t>(round_even(py * 256.0))};
}

// The planes at which a triangle must be clipped, as distances that are not negative inside.
double guard_distance(const HomogeneousPoint& p, int plane) {
    const double g = static_cast<double>(kGuardBand) * p.w;
    switch (plane) {
        case 0:
            return p.w - p.z;  // near
        case 1:
            return g + p.x;
        case 2:
            return g - p.x;
        case 3:
            return g + p.y;
        default:
            return g - p.y;
    }
}

// The depth plane of a triangle that crosses the near plane or the guard band, from its homogeneous
// vertices: z / w of the point with homogeneous barycentrics b is (b . z) / (b . w), where b is linear
// and b . w constant over the picture. Anchored at the clipped polygon's farthest vertex, where
// reversed depth is smallest and its rounding matters most.
bool clipped_depth_plane(TriangleSetup& t, const std::vector<HomogeneousPoint>& polygon,
                         const ProjectionView& projection) {
    const auto& v = t.vertices;
    double bx[3], by[3], bc[3];
    for (int i = 0; i < 3; ++i) {
        const ClipVertex<float>&j = v[(i + 1) % 3], &k = v[(i + 2) % 3];
        const double jx = j.x, jy = j.y, jw = j.w, kx = k.x, ky = k.y, kw = k.w;
        bx[i] = jy * kw - jw * ky;
        by[i] = jw * kx - jx * kw;
        bc[i] = jx * ky - jy * kx;
    }
    double det = 0, zx = 0, zy = 0, zc = 0;
    for (int i = 0; i < 3; ++i) {
        det += bc[i] * static_cast<double>(v[i].w);
        zx += bx[i] * static_cast<double>(v[i].z);
        zy += by[i] * static_cast<double>(v[i].z);
        zc += bc[i] * static_cast<double>(v[i].z);
    }
    if (!(std::fabs(det) > 0)) return false;
    t.orientation = det > 0 ? 1.0f : -1.0f;

    std::size_t farthest = 0;
    double lowest = polygon[0].z / polygon[0].w, highest = lowest;
    for (std::size_t i = 1; i < polygon.size(); ++i) {
        const double z = polygon[i].z / polygon[i].w;
        if (z < lowest) {
            lowest = z;
            farthest = i;
        }
        if (z > highest) highest = z;
    }
    const double per_x = 2.0 / (256.0 * static_cast<double>(projection.width));
    const double per_y = -2.0 / (256.0 * static_cast<double>(projection.height));
    const SnappedVertex anchor = t.polygon[farthest];
    const double ndc_x = anchor.x * per_x - 1.0, ndc_y = anchor.y * per_y + 1.0;
    t.depth.anchor_x = anchor.x;
    t.depth.anchor_y = anchor.y;
    t.depth.depth = static_cast<float>((zx * ndc_x + zy * ndc_y + zc) / det);
    t.depth.ddx = static_cast<float>(zx * per_x / det);
    t.depth.ddy = static_cast<float>(zy * per_y / det);
    t.depth.lowest = static_cast<float>(lowest);
    t.depth.highest = static_cast<float>(highest);
    return true;
}

void setup_clipped(const ProjectionView& projection, TriangleSetup& t) {
    std::vector<HomogeneousPoint> in, out;
    for (const ClipVertex<float>& v : t.vertices) in.push_back({v.x, v.y, v.z, v.w});
    for (int plane = 0; plane < 5; ++plane) {
        clip_by_plane(in, out, [plane](const HomogeneousPoint& p) { return guard_distance(p, plane); });
        std::swap(in, out);
    }
    t.kind = TriangleSetup::Kind::kOutside;
    if (in.size() < 3) return;
    for (const HomogeneousPoint& p : in) {
        if (!(p.w > 0)) return;  // an orthographic near plane behind the eye cannot occur; a point at w = 0 can
        t.polygon[t.vertex_count++] = snap_point(p, projection);
    }
    t.kind = clipped_depth_plane(t, in, projection) ? TriangleSetup::Kind::kClipped : TriangleSetup::Kind::kDegenerate;
}

}  // namespace

void setup_triangle(const InstanceView& instance, std::uint32_t index, const ProjectionView& projection,
                    TriangleSetup& t) {
    t.vertex_count = 0;
    std::uint32_t all = ~0u, any = 0;
    bool finite = true;
    for (int i = 0; i < 3; ++i) {
        const float* p = instance.mesh.positions + 3 * std::size_t{instance.mesh.triangles[3 * std::size_t{index} + i]};
        t.vertices[i] = to_clip(instance.object_to_clip, Vec3T<float>{p[0], p[1], p[2]});
        const std::uint32_t code = out_code(t.vertices[i]);
        all &= code;
        any |= code;
        finite = finite && usable(t.vertices[i]);
    }
    if (!finite) {
        t.kind = TriangleSetup::Kind::kDegenerate;
        return;
    }
    if (all & ~static_cast<std::uint32_t>(kOutGuard)) {
        t.kind = TriangleSetup::Kind::kOutside;
        return;
    }
    if (any & kMustClip) {
        setup_clipped(projection, t);
        return;
    }
    PictureVertex<float> p[3];
    float z[3];
    for (int i = 0; i < 3; ++i) {
        p[i] = to_picture(t.vertices[i], projection.width, projection.height);
        z[i] = t.vertices[i].z / t.vertices[i].w;
        t.polygon[t.vertex_count++] = {p[i].snapped_x, p[i].snapped_y};
    }
    const std::int64_t area = twice_area(t.polygon[0], t.polygon[1], t.polygon[2]);
    if (area == 0) {
        t.kind = TriangleSetup::Kind::kDegenerate;
        return;
    }
    t.kind = TriangleSetup::Kind::kPlain;
    t.orientation = area < 0 ? 1.0f : -1.0f;
    t.depth = depth_plane(p, z);
}

}  // namespace tessera
