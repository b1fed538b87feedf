#include "shading/triangle_setup.h"

#include "geometry/clip.h"

#include <cmath>
#include <utility>

namespace tessera {
namespace {

SnappedVertex snap_point(const HomogeneousPoint& p, const ProjectionView& projection) {
    const double half_w = 0.5 * static_cast<double>(projection.width),
                 half_h = 0.5 * static_cast<double>(projection.height);
    const double px = p.x / p.w * half_w + half_w, py = half_h - p.y / p.w * half_h;
    return {static_cast<std::int32_t>(round_even(px * 256.0)), static_cast<std::int32_t>(round_even(py * 256.0))};
}

// The homogeneous edge functions of a triangle as planes over normalised device coordinates:
// the barycentrics of the point seen at (x, y), over its w, are (bx x + by y + bc) / det.
struct HomogeneousEdges {
    double bx[3], by[3], bc[3], det = 0;

    explicit HomogeneousEdges(const ClipVertex<float> (&v)[3]) {
        for (int i = 0; i < 3; ++i) {
            const ClipVertex<float>&j = v[(i + 1) % 3], &k = v[(i + 2) % 3];
            const double jx = j.x, jy = j.y, jw = j.w, kx = k.x, ky = k.y, kw = k.w;
            bx[i] = jy * kw - jw * ky;
            by[i] = jw * kx - jx * kw;
            bc[i] = jx * ky - jy * kx;
        }
        for (int i = 0; i < 3; ++i) det += bc[i] * static_cast<double>(v[i].w);
    }
};

// Normalised device coordinates over positions in 1/256 pixel.
struct PictureScale {
    double per_x, per_y;
    explicit PictureScale(const ProjectionView& p)
        : per_x(2.0 / (256.0 * static_cast<double>(p.width))), per_y(-2.0 / (256.0 * static_cast<double>(p.height))) {}
    double x(std::int32_t at) const { return at * per_x - 1.0; }
    double y(std::int32_t at) const { return at * per_y + 1.0; }
};

// The depth plane of a triangle that crosses the near plane or the guard band, from its homogeneous
// vertices: z / w of the point with homogeneous barycentrics b is (b . z) / (b . w), where b is linear
// and b . w constant over the picture. Anchored at the clipped polygon's farthest vertex, where
// reversed depth is smallest and its rounding matters most.
bool clipped_depth_plane(TriangleSetup& t, const std::vector<HomogeneousPoint>& polygon,
                         const ProjectionView& projection) {
    const auto& v = t.vertices;
    const HomogeneousEdges e(v);
    const double det = e.det;
    double zx = 0, zy = 0, zc = 0;
    for (int i = 0; i < 3; ++i) {
        zx += e.bx[i] * static_cast<double>(v[i].z);
        zy += e.by[i] * static_cast<double>(v[i].z);
        zc += e.bc[i] * static_cast<double>(v[i].z);
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
    const PictureScale scale(projection);
    const SnappedVertex anchor = t.polygon[farthest];
    t.depth.anchor_x = anchor.x;
    t.depth.anchor_y = anchor.y;
    t.depth.depth = static_cast<float>((zx * scale.x(anchor.x) + zy * scale.y(anchor.y) + zc) / det);
    t.depth.ddx = static_cast<float>(zx * scale.per_x / det);
    t.depth.ddy = static_cast<float>(zy * scale.per_y / det);
    t.depth.lowest = static_cast<float>(lowest);
    t.depth.highest = static_cast<float>(highest);
    return true;
}

void setup_clipped(const ProjectionView& projection, TriangleSetup& t) {
    std::vector<HomogeneousPoint> in, out;
    for (const ClipVertex<float>& v : t.vertices) in.push_back({v.x, v.y, v.z, v.w});
    for (int plane = 0; plane < 5; ++plane) {
        clip_by_plane(in, out, [plane](const HomogeneousPoint& p) {
            return guard_distance(p, plane, static_cast<double>(kGuardBand));
        });
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

Corner<float> fetch_corner(const MeshView& mesh, std::uint32_t vertex) {
    const std::size_t v = vertex;
    Corner<float> c{};
    c.position = Vec3T<float>::load(mesh.positions + 3 * v);
    if (mesh.normals) c.normal = Vec3T<float>::load(mesh.normals + 3 * v);
    if (mesh.tangents) {
        const float* t = mesh.tangents + 4 * v;
        c.tangent = {t[0], t[1], t[2], t[3]};
    }
    if (mesh.colors) {
        const float* k = mesh.colors + 4 * v;
        c.color = {k[0], k[1], k[2], k[3]};
    }
    for (int i = 0; i < kMaxUvSets; ++i)
        if (mesh.uvs[i]) c.uv[i] = {mesh.uvs[i][2 * v], mesh.uvs[i][2 * v + 1]};
    return c;
}

void make_surface_record(const InstanceView& instance, std::uint32_t index, const TriangleSetup& setup,
                         const ProjectionView& projection, const SurfaceLayout& layout, float* record) {
    Corner<float> corners[3];
    for (int i = 0; i < 3; ++i)
        corners[i] = fetch_corner(instance.mesh, instance.mesh.triangles[3 * std::size_t{index} + i]);
    const float front = setup.front(instance) ? 1.0f : -1.0f;
    if (setup.kind == TriangleSetup::Kind::kPlain) {
        PictureVertex<float> p[3];
        for (int i = 0; i < 3; ++i) p[i] = to_picture(setup.vertices[i], projection.width, projection.height);
        make_planes(instance, layout, corners, setup.vertices, p, front, [&](int i, float v) { record[i] = v; });
        return;
    }
    // A corner may lie behind the eye: from its homogeneous coordinates, anchored with the depth plane.
    const HomogeneousEdges e(setup.vertices);
    const PictureScale scale(projection);
    const double x = scale.x(setup.depth.anchor_x), y = scale.y(setup.depth.anchor_y);
    record[0] = static_cast<float>(setup.depth.anchor_x);
    record[1] = static_cast<float>(setup.depth.anchor_y);
    record[2] = front;
    record[3] = layout.tangent >= 0 ? corners[0].tangent.w * instance.handedness : 1.0f;
    Vec3T<float> normals[3];
    camera_normals(instance, corners, normals);
    float numbers[3][kMaxSurfacePlanes];
    for (int i = 0; i < 3; ++i) {
        numbers[i][0] = 1;
        corner_numbers(instance, layout, corners[i], front, normals[i], numbers[i]);
    }
    for (int k = 0; k < layout.count; ++k) {
        double at_anchor = 0, ddx = 0, ddy = 0;
        for (int i = 0; i < 3; ++i) {
            const double a = numbers[i][k];
            at_anchor += a * (e.bx[i] * x + e.by[i] * y + e.bc[i]);
            ddx += a * e.bx[i];
            ddy += a * e.by[i];
        }
        float* plane = record + kSurfaceHeader + 3 * k;
        plane[0] = static_cast<float>(at_anchor / e.det);
        plane[1] = static_cast<float>(ddx * scale.per_x / e.det);
        plane[2] = static_cast<float>(ddy * scale.per_y / e.det);
    }
}

void make_even_record(const InstanceView& instance, std::uint32_t index, const ProjectionView& projection,
                      const SurfaceLayout& layout, float* record) {
    Corner<float> corners[3];
    for (int i = 0; i < 3; ++i)
        corners[i] = fetch_corner(instance.mesh, instance.mesh.triangles[3 * std::size_t{index} + i]);
    const Vec3T<float> own = geometric_normal(instance, corners[0].position, corners[1].position, corners[2].position);
    const Vec3T<float> at = transform_point(instance.object_to_camera, corners[0].position);
    const float along = projection.orthographic ? -own.z : dot(own, at);
    const float w = to_clip(instance.object_to_clip, corners[0].position).w;
    record[0] = record[1] = 0;
    record[2] = along > 0 ? -1.0f : 1.0f;
    record[3] = layout.tangent >= 0 ? corners[0].tangent.w * instance.handedness : 1.0f;
    Vec3T<float> normals[3];
    camera_normals(instance, corners, normals);
    float numbers[kMaxSurfacePlanes];
    numbers[0] = 1;
    corner_numbers(instance, layout, corners[0], record[2], normals[0], numbers);
    for (int k = 0; k < layout.count; ++k) {
        float* plane = record + kSurfaceHeader + 3 * k;
        plane[0] = w > 0 ? numbers[k] / w : numbers[k];
        plane[1] = plane[2] = 0;
    }
}

}  // namespace tessera
