// The kernel that makes the surface points of spheres and discs, of every instruction set against one lane; and that
// one against the surface function.
#include "shading/shape_surface.h"
#include "trace_kernels/wave_arrays.h"

#include <cmath>

namespace tessera {
namespace {

using namespace test;

class ShapeKernels : public TraceKernelTest {};

// A sphere or disc before the lens, placed by a matrix that turns it at random and scales its axes.
struct Setting {
    Random random;
    KernelWorld world;
    KernelMesh mesh;  // for its attributes
    MaterialView material;
    InstanceView instance;
    SurfaceLayout layout;
    ProjectionView projection;

    Setting(std::uint32_t seed, std::uint32_t number, bool orthographic, const Vec3T<float>& scale, float radius)
        : random(seed), world(random), mesh(random, Place::kMedium, 3), material(world.material(number)) {
        instance = mesh.instance();
        if (seed % 3 == 0) instance.mesh.tangents = nullptr;
        const Vec3T<float> x = random.unit(), z = normalize_or(cross(x, random.unit()), {0, 0, 1}), y = cross(z, x);
        const Vec3T<float> at{random.in(-1, 1), random.in(-1, 1), -3};
        const Vec3T<float> axes[3] = {x * scale.x, y * scale.y, z * scale.z},
                           inverse[3] = {x * (1 / scale.x), y * (1 / scale.y), z * (1 / scale.z)};
        float* const m = instance.object_to_camera;
        for (int c = 0; c < 3; ++c) {
            m[c] = axes[c].x, m[4 + c] = axes[c].y, m[8 + c] = axes[c].z;
            float* const n = instance.normal_to_camera;
            n[c] = inverse[c].x, n[3 + c] = inverse[c].y, n[6 + c] = inverse[c].z;
            float* const row = instance.shape.camera_to_object + 4 * c;
            row[0] = inverse[c].x, row[1] = inverse[c].y, row[2] = inverse[c].z, row[3] = -dot(inverse[c], at);
        }
        m[3] = at.x, m[7] = at.y, m[11] = at.z;
        instance.handedness = scale.x * scale.y * scale.z < 0 ? -1.0f : 1.0f;
        instance.shape.kind = seed % 2 ? ShapeView::Kind::kSphere : ShapeView::Kind::kDisc;
        instance.shape.radius = radius;
        layout = surface_layout(instance.mesh, material, orthographic);
        projection = world.projection;
        projection.orthographic = orthographic;
    }
};

struct Case {
    Vec3T<float> scale;
    float radius;
};
constexpr Case kCases[] = {{{1, 1, 1}, 1},     {{-1, 1, 1}, 0.5f}, {{0.3f, -2, 0.7f}, 1}, {{-1, -0.1f, -3}, 2},
                           {{1, 1, 1}, 1e-4f}, {{1, 1, 1}, 1e4f},  {{1e-3f, 1, 1}, 1e9f}, {{1e6f, 1e6f, 1e6f}, 1e-6f}};

// Calls `check(setting)` for shapes of all kinds and materials.
template <class Check>
void for_all_settings(const Check& check) {
    std::uint32_t seed = 1;
    for (const bool orthographic : {false, true})
        for (const Case& c : kCases)
            for (std::uint32_t number = 0; number < KernelWorld::kMaterials; number += 1 + seed % 3) {
                Setting s(seed++, number, orthographic, c.scale, c.radius);
                check(s);
                if (testing::Test::HasFatalFailure()) return;
            }
}

constexpr float kSpread = 0.01f, kFootprintScale = 0.5f, kSize = 20;

ShapeSurfacesJob make_job(Setting& s, const std::uint32_t* name, std::uint32_t count, std::uint32_t first) {
    ShapeSurfacesJob job{};
    job.instance = &s.instance;
    job.material = &s.material;
    job.layout = s.layout;
    job.projection = &s.projection;
    job.name = name;
    job.count = count, job.first = first;
    job.spread = kSpread, job.footprint_scale = kFootprintScale;
    job.instance_size = kSize;
    return job;
}

// Rays from everywhere: about the shape, far away, within it, beside it, of numbers of all kinds.
void fill(GuardedWave& rays, Setting& s, bool odd) {
    fill_rays(rays, s.random, odd);
    const float* m = s.instance.object_to_camera;
    const Vec3T<float> centre{m[3], m[7], m[11]};
    for (std::uint32_t i = 0; i < rays.count(); ++i) {
        if (odd && i % 2) continue;
        const Vec3T<float> origin = rays.count() % 3 ? s.random.box(5) : s.random.unit() * 1e4f;
        const Vec3T<float> aim = transform_point(m, s.random.box(1.2f * s.instance.shape.radius));
        if (i % 5) rays.set3(kOriginX, i, i % 7 ? origin : centre + s.random.box(0.1f));
        if (i % 3) rays.set3(kDirectionX, i, normalize_or(aim - cone_ray(rays.arrays(), i).origin, {0, 0, -1}));
    }
}

TEST_P(ShapeKernels, SamePointsOfRays) {
    std::size_t points = 0;
    for_all_settings([&](Setting& s) {
        for (std::uint32_t count = 1; count <= 40; count += 1 + s.random.below(3)) {
            GuardedWave rays(kRayNumbers, 50 + count % 2);
            fill(rays, s, count % 2);
            const std::uint32_t first = s.random.below(20);
            GuardedArray<std::uint32_t> ray(count), name(count);
            for (std::uint32_t i = 0; i < count; ++i) ray[i] = s.random.below(50), name[i] = s.random.below(2);
            GuardedWave got(kPointNumbers, first + count), want(kPointNumbers, got);
            GuardedArray<float> far_got(first + count + kMaxLanes), far_want(far_got.size());
            for (std::size_t i = 0; i < far_got.size(); ++i) far_got[i] = far_want[i] = -7;
            ShapeSurfacesJob job = make_job(s, name.data(), count, first);
            job.rays = rays.arrays(), job.ray = ray.data();
            job.points = got.arrays(), job.distance = far_got.data();
            traced().shape_surfaces(job);
            job.points = want.arrays(), job.distance = far_want.data();
            one_lane().shape_surfaces(job);
            // What lies before `first` is as it was in both.
            ASSERT_TRUE(got.same(want, kPointNumbers, first + count)) << count;
            ASSERT_TRUE(same_floats(far_got.data(), far_want.data(), first + count));
            for (std::uint32_t i = 0; i < first; ++i) ASSERT_EQ(got[kPositionX][i], -7.0f);
            ASSERT_FALSE(got.changed() || far_got.changed() || rays.changed());
            points += count;
        }
    });
    EXPECT_GT(points, 10000u);
}

TEST_P(ShapeKernels, SamePointsOfThePicture) {
    std::size_t points = 0;
    for_all_settings([&](Setting& s) {
        for (std::uint32_t count = 1; count <= 40; count += 1 + s.random.below(3)) {
            const std::uint32_t first = s.random.below(20);
            GuardedArray<std::int32_t> x(count + kMaxLanes - 1), y(x.size());
            GuardedArray<std::uint32_t> name(count);
            for (std::uint32_t i = 0; i < x.size(); ++i) {
                x[i] = static_cast<std::int32_t>(s.random.below(KernelMesh::kWidth * 256));
                y[i] = static_cast<std::int32_t>(s.random.below(KernelMesh::kHeight * 256));
            }
            for (std::uint32_t i = 0; i < count; ++i) name[i] = s.random.below(2);
            GuardedWave got(kPointNumbers, first + count), want(kPointNumbers, got);
            ShapeSurfacesJob job = make_job(s, name.data(), count, first);
            job.x = x.data(), job.y = y.data();
            job.points = got.arrays();
            traced().shape_surfaces(job);
            job.points = want.arrays();
            one_lane().shape_surfaces(job);
            ASSERT_TRUE(got.same(want, kPointNumbers, first + count)) << count;
            for (std::uint32_t i = 0; i < first; ++i) ASSERT_EQ(got[kPositionX][i], -7.0f);
            ASSERT_FALSE(got.changed());
            points += count;
        }
    });
    EXPECT_GT(points, 10000u);
}

// The kernel's points are the surface function's, as the reference engines call it.
TEST_P(ShapeKernels, PointsAreTheSurfaceFunctions) {
    for_all_settings([&](Setting& s) {
        constexpr std::uint32_t kCount = 37;
        const PictureRays picture(s.projection);
        GuardedWave rays(kRayNumbers, kCount), points(kPointNumbers, kCount);
        fill(rays, s, false);
        std::vector<std::uint32_t> ray(kCount), name(kCount);
        std::vector<std::int32_t> x(kCount + kMaxLanes), y(kCount + kMaxLanes);
        std::vector<float> far(kCount + kMaxLanes);
        for (std::uint32_t i = 0; i < kCount; ++i) {
            ray[i] = kCount - 1 - i, name[i] = i % 2;
            x[i] = static_cast<std::int32_t>(s.random.below(KernelMesh::kWidth * 256));
            y[i] = static_cast<std::int32_t>(s.random.below(KernelMesh::kHeight * 256));
        }
        for (const bool camera : {false, true}) {
            ShapeSurfacesJob job = make_job(s, name.data(), kCount, 0);
            if (camera)
                job.x = x.data(), job.y = y.data();
            else
                job.rays = rays.arrays(), job.ray = ray.data(), job.distance = far.data();
            job.points = points.arrays();
            traced().shape_surfaces(job);
            for (std::uint32_t i = 0; i < kCount; ++i) {
                const ConeRay<float> cone =
                    camera ? picture_ray(s.projection, picture, static_cast<float>(x[i]), static_cast<float>(y[i]))
                           : cone_ray(rays.arrays(), ray[i]);
                RaySurface<float> want =
                    shape_surface<float>(s.instance, cone, name[i] == kLeavingSphere, kSpread, kFootprintScale);
                if (s.layout.tangent >= 0) want.point.normal = shading_normal(s.material, want.point);
                const auto at = [&](int number) {
                    return Vec3T<float>{points[number][i], points[number + 1][i], points[number + 2][i]};
                };
                const auto expect = [&](int number, const Vec3T<float>& v) {
                    const Vec3T<float> got = at(number);
                    ASSERT_TRUE(same_floats(&got.x, &v.x, 3)) << number;
                };
                expect(kPositionX, want.point.position);
                expect(kViewX, want.point.view);
                expect(kNormalX, want.point.normal);
                expect(kFlatX, want.point.geometric_normal);
                ASSERT_EQ(points[kFacing][i], want.point.side);
                ASSERT_EQ(points[kTimes][i], camera ? 1.0f : rays[kThroughput][ray[i]]);
                ASSERT_EQ(points[kRounding][i], coordinate_size(want.point.position, kSize));
                if (!camera) {
                    ASSERT_EQ(far[i], want.distance);
                    ASSERT_EQ(points[kFootprint][i], want.width);
                }
            }
        }
    });
}

INSTANTIATE_TEST_SUITE_P(Kernels, ShapeKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
