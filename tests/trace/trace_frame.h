// Frames made by hand for the tests of tracing: meshes placed by matrices, rays in camera space, and what is true of
// them by the double-precision reference tracer.
#pragma once

#include "geometry/matrix.h"
#include "geometry/support.h"
#include "reference/bvh.h"
#include "trace/embree_scene.h"

#include <tessera/scene.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace tessera::test {

inline constexpr std::uint64_t kPlenty = std::uint64_t{1} << 32;

inline std::vector<Isa> trace_isas() {
    std::vector<Isa> isas;
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512})
        if (isa_supported(isa)) isas.push_back(isa);
    return isas;
}

struct Rows {
    float m[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
};

inline Rows moved(Vec3 by) { return {{1, 0, 0, by.x, 0, 1, 0, by.y, 0, 0, 1, by.z}}; }

// Turned at random, its axes scaled, then moved.
inline Rows turned(Random& random, Vec3 scale, Vec3 by) {
    const Quat q = random.rotation();
    const float x = q.x, y = q.y, z = q.z, w = q.w;
    const float r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                        2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                        2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    return {{r[0] * scale.x, r[1] * scale.y, r[2] * scale.z, by.x, r[3] * scale.x, r[4] * scale.y, r[5] * scale.z, by.y,
             r[6] * scale.x, r[7] * scale.y, r[8] * scale.z, by.z}};
}

inline float determinant(const float* m) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

// A frame, and all that it points to.
class TraceFrame {
  public:
    // Returns its number.
    std::size_t add_mesh(std::vector<Vec3> positions, std::vector<std::uint32_t> indices, bool deformed = false) {
        auto primitive = std::make_unique<Primitive>();
        primitive->normals.assign(positions.size(), {0, 0, 1});
        primitive->positions = std::move(positions);
        primitive->indices = std::move(indices);
        meshes_.push_back(std::make_unique<PreparedMesh>(Primitive{}, *primitive));
        meshes_.back()->deformed = deformed;
        primitives_.push_back(std::move(primitive));
        return meshes_.size() - 1;
    }
    // Spheres and discs: drawn by their formula where the frame has exact_shapes when they are placed.
    std::size_t add_shape(const Shape& shape) {
        primitives_.push_back(std::make_unique<Primitive>(shape_primitive(shape)));
        meshes_.push_back(std::make_unique<PreparedMesh>(Primitive{}, *primitives_.back()));
        return meshes_.size() - 1;
    }
    Shape& shape(std::size_t mesh) { return *primitives_[mesh]->shape; }
    std::vector<Vec3>& positions(std::size_t mesh) { return primitives_[mesh]->positions; }
    const std::vector<std::uint32_t>& indices(std::size_t mesh) const { return primitives_[mesh]->indices; }
    PreparedMesh& mesh(std::size_t m) { return *meshes_[m]; }

    void place(std::size_t mesh, const Rows& rows = {}, const TraceClass& type = {}) {
        InstanceView instance{};
        instance.mesh = meshes_[mesh]->view;
        std::copy_n(rows.m, 12, instance.object_to_camera);
        instance.handedness = determinant(rows.m) < 0 ? -1.0f : 1.0f;
        const std::optional<Shape>& shape = primitives_[mesh]->shape;
        if (shape && frame.exact_shapes && invert_rows(rows.m, instance.shape.camera_to_object)) {
            const bool sphere = shape->type == Shape::Type::kSphere;
            instance.shape.kind = sphere ? ShapeView::Kind::kSphere : ShapeView::Kind::kDisc;
            instance.shape.radius = shape->radius;
            instance.mesh.triangle_count = sphere ? 2 : 1;
            frame.has_exact_shapes = true;
        }
        instance.first_triangle = frame.triangle_count;
        frame.triangle_count += instance.mesh.triangle_count;
        frame.instances.push_back(instance);
        frame.prepared.push_back(meshes_[mesh].get());
        classes.push_back(type);
    }
    void clear() {
        frame.instances.clear();
        frame.prepared.clear();
        frame.triangle_count = 0;
        frame.has_exact_shapes = false;
        classes.clear();
    }

    Frame frame;
    std::vector<TraceClass> classes;

  private:
    std::vector<std::unique_ptr<Primitive>> primitives_;
    std::vector<std::unique_ptr<PreparedMesh>> meshes_;
};

// `count` triangles without order in a cube of half side 1.
inline std::size_t add_soup(TraceFrame& f, Random& random, std::uint32_t count, float size = 0.2f,
                            bool deformed = false) {
    std::vector<Vec3> positions;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3 centre = random.vec3(1);
        for (int k = 0; k < 3; ++k) {
            indices.push_back(static_cast<std::uint32_t>(positions.size()));
            positions.push_back(centre + random.vec3(size));
        }
    }
    return f.add_mesh(std::move(positions), std::move(indices), deformed);
}

struct Ray {
    Vec3 org, dir;
    float t_near = 0, t_far = std::numeric_limits<float>::infinity();
    std::uint32_t mask = kMeetsAll;
};

// From a sphere of radius 4 to somewhere in the cube.
inline Ray random_ray(Random& random) {
    const Vec3 org = random.unit() * 4.0f;
    return {org, random.vec3(1) - org};
}

struct Hit {
    std::uint32_t instance = kNoHit, triangle = kNoHit;
    float t = std::numeric_limits<float>::infinity();
    friend bool operator==(const Hit&, const Hit&) = default;
};

template <int W>
void set_ray(RayPacket<W>& p, int i, const Ray& ray, const float* m) {
    const Vec3 o = ray.org, d = ray.dir;
    p.org_x[i] = m[0] * o.x + m[1] * o.y + m[2] * o.z + m[3];
    p.org_y[i] = m[4] * o.x + m[5] * o.y + m[6] * o.z + m[7];
    p.org_z[i] = m[8] * o.x + m[9] * o.y + m[10] * o.z + m[11];
    p.dir_x[i] = m[0] * d.x + m[1] * d.y + m[2] * d.z;
    p.dir_y[i] = m[4] * d.x + m[5] * d.y + m[6] * d.z;
    p.dir_z[i] = m[8] * d.x + m[9] * d.y + m[10] * d.z;
    p.t_near[i] = ray.t_near;
    p.t_far[i] = ray.t_far;
    p.mask[i] = ray.mask;
}

// Calls `trace(valid, packet, first)` for the rays in packets; lanes beyond the last ray are off.
template <int W, class Trace>
void in_packets(const EmbreeScene& scene, const std::vector<Ray>& rays, Trace&& trace) {
    for (std::size_t first = 0; first < rays.size(); first += W) {
        RayPacket<W> packet{};
        int valid[W] = {};
        for (int i = 0; i < W && first + static_cast<std::size_t>(i) < rays.size(); ++i) {
            set_ray(packet, i, rays[first + static_cast<std::size_t>(i)], scene.trace_from_camera());
            valid[i] = -1;
        }
        trace(valid, packet, first);
    }
}

struct NearestOptions {
    bool coherent = false, from_camera = true;
    std::vector<SheerHit>* sheer = nullptr;  // `lane` becomes the number of the ray
};

template <int W>
std::vector<Hit> nearest(const EmbreeScene& scene, const std::vector<Ray>& rays, const NearestOptions& options = {}) {
    std::vector<Hit> hits(rays.size());
    in_packets<W>(scene, rays, [&](const int* valid, RayPacket<W>& p, std::size_t first) {
        std::vector<SheerHit> sheer;
        scene.nearest<W>(valid, p, options.coherent, options.from_camera, options.sheer ? &sheer : nullptr);
        for (SheerHit& s : sheer) {
            EXPECT_TRUE(s.lane < W && valid[s.lane]);
            s.lane += static_cast<std::uint32_t>(first);
            options.sheer->push_back(s);
        }
        for (int i = 0; i < W; ++i) {
            if (!valid[i]) continue;
            const std::size_t r = first + static_cast<std::size_t>(i);
            if (p.instance[i] != kNoHit) hits[r] = {p.instance[i], p.triangle[i], p.t_far[i]};
            EXPECT_EQ(p.mask[i], rays[r].mask);
        }
    });
    return hits;
}

template <int W>
std::vector<int> occluded(const EmbreeScene& scene, const std::vector<Ray>& rays, bool coherent = false) {
    std::vector<int> blocked(rays.size());
    in_packets<W>(scene, rays, [&](const int* valid, RayPacket<W>& p, std::size_t first) {
        scene.occluded<W>(valid, p, coherent);
        for (int i = 0; i < W; ++i)
            if (valid[i])
                blocked[first + static_cast<std::size_t>(i)] = p.t_far[i] == -std::numeric_limits<float>::infinity();
    });
    return blocked;
}

template <int W>
std::vector<SheerHit> find_sheer(const EmbreeScene& scene, const std::vector<Ray>& rays) {
    std::vector<SheerHit> all;
    in_packets<W>(scene, rays, [&](const int* valid, RayPacket<W>& p, std::size_t first) {
        std::vector<SheerHit> sheer;
        for (std::uint32_t& mask : p.mask) mask &= kMeetsSheer;  // nothing solid stops them
        scene.occluded<W>(valid, p, false, &sheer);
        for (SheerHit& s : sheer) {
            s.lane += static_cast<std::uint32_t>(first);
            all.push_back(s);
        }
    });
    return all;
}

// What the reference says.
class Truth {
  public:
    explicit Truth(const TraceFrame& f) : f_(f), bvh_(f.frame) {}

    struct Meeting {
        std::uint32_t instance, triangle;
        double t;
        bool front;
    };
    // All triangles that the ray meets by its mask, the nearest first, then by number.
    std::vector<Meeting> along(const Ray& ray) const {
        std::vector<Meeting> all;
        const CastRay cast = in_double(ray);
        bvh_.traverse(cast, ray.t_near, ray.t_far, [&](const RayHit& hit, double t_max) {
            const Meeting m = meeting(cast, hit);
            if (f_.classes[m.instance].mask & ray.mask) all.push_back(m);
            return t_max;
        });
        std::sort(all.begin(), all.end(), before);
        return all;
    }
    bool shown(const Meeting& m, bool from_camera) const {
        const TraceClass& type = f_.classes[m.instance];
        return m.front || !type.culled || (type.seen_inside && !from_camera);
    }
    bool sheer(std::uint32_t instance) const { return f_.classes[instance].mask & kMeetsSheer; }
    bool undecided(std::uint32_t instance) const { return f_.classes[instance].undecided; }
    Hit nearest(const Ray& ray, bool from_camera = true) const {
        std::optional<Meeting> best;
        const CastRay cast = in_double(ray);
        bvh_.traverse(cast, ray.t_near, ray.t_far, [&](const RayHit& hit, double t_max) {
            const Meeting m = meeting(cast, hit);
            if (!(f_.classes[m.instance].mask & ray.mask) || undecided(m.instance) || !shown(m, from_camera))
                return t_max;
            if (best && !before(m, *best)) return t_max;
            best = m;
            return m.t;
        });
        return best ? Hit{best->instance, best->triangle, static_cast<float>(best->t)} : Hit{};
    }

    // Whether rounding alone may make the ray meet this triangle, or not, or from the other side.
    bool doubtful(const Ray& ray, std::uint32_t instance, std::uint32_t triangle) const {
        const CastRay cast = in_double(ray);
        if (f_.frame.instances[instance].shape) return doubtful_shape(cast, f_.frame.instances[instance]);
        Vec3d v[3];
        corners(instance, triangle, v);
        const Vec3d n = cross(v[1] - v[0], v[2] - v[0]), d = cast.direction;
        const double area = std::sqrt(dot(n, n)), along = dot(n, d), cosine = along / (area * std::sqrt(dot(d, d)));
        if (!(std::fabs(cosine) > 1e-4)) return true;
        const Vec3d p = cast.origin + d * (dot(n, v[0] - cast.origin) / along);
        double longest = 0, least = 1e30, scale = std::sqrt(dot(cast.origin, cast.origin));
        for (int i = 0; i < 3; ++i) {
            const Vec3d edge = v[(i + 1) % 3] - v[i];
            longest = std::max(longest, std::sqrt(dot(edge, edge)));
            scale = std::max(scale, std::sqrt(dot(v[i], v[i])));
            least = std::min(least, dot(cross(edge, p - v[i]), n) / (area * std::sqrt(dot(edge, edge))));
        }
        return std::fabs(least) < 1e-5 * (scale + longest) / std::fabs(cosine);
    }
    // Whether `got` is not to be told from what is nearest: its t is the same, or rounding decides over one of the two.
    bool agrees(const Ray& ray, const Hit& got, const Hit& want) const {
        if (got.instance != kNoHit && want.instance != kNoHit && near_enough(got.t, want.t)) return true;
        if (got.instance == kNoHit && want.instance == kNoHit) return true;
        return (got.instance != kNoHit && doubtful(ray, got.instance, got.triangle)) ||
               (want.instance != kNoHit && doubtful(ray, want.instance, want.triangle));
    }
    static bool near_enough(float a, float b) { return std::fabs(a - b) <= 2e-5f * std::max(std::fabs(a), 0.1f); }

  private:
    static CastRay in_double(const Ray& ray) {
        return {{ray.org.x, ray.org.y, ray.org.z}, {ray.dir.x, ray.dir.y, ray.dir.z}};
    }
    // A ray by the rim, or along the disc.
    static bool doubtful_shape(const CastRay& ray, const InstanceView& instance) {
        const auto [o, d] = in_object(ray, instance);
        const double r = instance.shape.radius, size = std::sqrt(dot(o, o)) + r, along = std::sqrt(dot(d, d));
        const bool sphere = instance.shape.kind == ShapeView::Kind::kSphere;
        if (!sphere && std::fabs(d.y) < 1e-3 * along) return true;
        const Vec3d p = o + d * (sphere ? -dot(o, d) / dot(d, d) : -o.y / d.y);
        const double far = std::sqrt(dot(p, p));
        // There a sphere's roots go by the square root of what rounding does.
        return std::fabs(far - r) < (sphere ? 2e-3 * r : 0) + 1e-5 * size * along / (sphere ? along : std::fabs(d.y));
    }
    static CastRay in_object(const CastRay& ray, const InstanceView& instance) {
        const float* m = instance.shape.camera_to_object;
        const auto turn = [&](const Vec3d& v) {
            return Vec3d{m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
                         m[8] * v.x + m[9] * v.y + m[10] * v.z};
        };
        return {turn(ray.origin) + Vec3d{m[3], m[7], m[11]}, turn(ray.direction)};
    }
    void corners(std::uint32_t instance, std::uint32_t triangle, Vec3d (&v)[3]) const {
        const InstanceView& i = f_.frame.instances[instance];
        const float* m = i.object_to_camera;
        for (std::size_t k = 0; k < 3; ++k) {
            const float* p = i.mesh.positions + 3 * std::size_t{i.mesh.triangles[3 * std::size_t{triangle} + k]};
            const double x = p[0], y = p[1], z = p[2];
            v[k] = {m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
                    m[8] * x + m[9] * y + m[10] * z + m[11]};
        }
    }
    static bool before(const Meeting& a, const Meeting& b) {
        return std::tie(a.t, a.instance, a.triangle) < std::tie(b.t, b.instance, b.triangle);
    }
    Meeting meeting(const CastRay& ray, const RayHit& hit) const {
        const auto instance = static_cast<std::uint32_t>(&f_.frame.instance_of(hit.triangle) - &f_.frame.instances[0]);
        const std::uint32_t triangle = hit.triangle - f_.frame.instances[instance].first_triangle;
        if (const ShapeView& shape = f_.frame.instances[instance].shape) {
            const bool front = shape.kind == ShapeView::Kind::kSphere
                                   ? triangle == 0
                                   : in_object(ray, f_.frame.instances[instance]).direction.y < 0;
            return {instance, triangle, hit.t, front};
        }
        Vec3d v[3];
        corners(instance, triangle, v);
        const double along = dot(cross(v[1] - v[0], v[2] - v[0]), ray.direction);
        return {instance, triangle, hit.t, f_.frame.instances[instance].handedness * along < 0};
    }

    const TraceFrame& f_;
    Bvh bvh_;
};

// Counts the rays for which a trace and the reference disagree beyond rounding, and for which they differ at all.
struct Agreement {
    int rays = 0, hit = 0, differ = 0, wrong = 0;
};
inline Agreement compare(const Truth& truth, const std::vector<Ray>& rays, const std::vector<Hit>& hits,
                         bool from_camera = true) {
    Agreement a;
    for (std::size_t r = 0; r < rays.size(); ++r) {
        const Hit want = truth.nearest(rays[r], from_camera);
        ++a.rays;
        a.hit += want.instance != kNoHit;
        a.differ += want.instance != hits[r].instance || want.triangle != hits[r].triangle;
        a.wrong += !truth.agrees(rays[r], hits[r], want);
    }
    return a;
}
inline void expect_agreement(const Agreement& a, double most_different = 1e-3) {
    EXPECT_EQ(a.wrong, 0) << "of " << a.rays << " rays, " << a.hit << " of which hit";
    EXPECT_LE(a.differ, most_different * a.rays) << "of " << a.rays;
    EXPECT_GT(a.hit, a.rays / 10);
    testing::Test::RecordProperty("differ", a.differ);
}

// By ray, instance and triangle.
using Found = std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>>;
inline Found found(const std::vector<SheerHit>& sheer) {
    Found all;
    for (const SheerHit& s : sheer) all.insert({s.lane, s.instance, s.triangle});
    return all;
}

// All sheer surfaces along the rays, from both sides, in packets of every width.
inline void expect_all_sheer(const EmbreeScene& scene, const Truth& truth, const std::vector<Ray>& rays) {
    Found all;
    for (std::uint32_t r = 0; r < rays.size(); ++r)
        for (const auto& m : truth.along(rays[r]))
            if (truth.sheer(m.instance)) all.insert({r, m.instance, m.triangle});
    for (const Found& got : {found(find_sheer<1>(scene, rays)), found(find_sheer<4>(scene, rays)),
                             found(find_sheer<8>(scene, rays)), found(find_sheer<16>(scene, rays))}) {
        std::size_t differ = 0;
        for (const auto& [r, i, t] : all) differ += !got.count({r, i, t}) && !truth.doubtful(rays[r], i, t);
        for (const auto& [r, i, t] : got) differ += !all.count({r, i, t}) && !truth.doubtful(rays[r], i, t);
        EXPECT_EQ(differ, 0u) << "of " << all.size();
    }
}

// Whether anything is along the rays, in packets of every kind; at most so many at an edge may fall either way.
inline void expect_occluded(const EmbreeScene& scene, const Truth& truth, const std::vector<Ray>& rays, int most) {
    std::vector<int> want;
    for (const Ray& ray : rays) want.push_back(!truth.along(ray).empty());
    for (const bool coherent : {false, true})
        for (const std::vector<int>& got : {occluded<1>(scene, rays, coherent), occluded<4>(scene, rays, coherent),
                                            occluded<8>(scene, rays, coherent), occluded<16>(scene, rays, coherent)}) {
            int differ = 0;
            for (std::size_t r = 0; r < rays.size(); ++r) differ += got[r] != want[r];
            EXPECT_LE(differ, most);
        }
}

}  // namespace tessera::test
