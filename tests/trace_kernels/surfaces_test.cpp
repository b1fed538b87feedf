// Kernels that make the surface points of a wave, of every instruction set against one lane: planes of triangles,
// samples of the picture, hits of rays.
#include "trace_kernels/wave_arrays.h"

#include <cmath>

namespace tessera {
namespace {

using namespace test;

class WaveSurfaceKernels : public TraceKernelTest {};

// A mesh, without some attributes by turns, as the only instance of a world.
struct Setting {
    Random random;
    KernelWorld world;
    KernelMesh mesh;
    MaterialView material;
    SurfaceSource source;
    SurfaceLayout layout;

    Setting(std::uint32_t seed, Place place, std::uint32_t number, bool orthographic = false)
        : random(seed), world(random), mesh(random, place, 3 + random.below(60)), material(world.material(number)) {
        MeshView& m = mesh.instance().mesh;
        if (seed % 2) m.tangents = nullptr;
        if (seed % 3 == 1) m.colors = nullptr;
        if (seed % 5 == 1) m.uvs[0] = m.uvs[1] = nullptr;
        InstanceView& i = mesh.instance();
        if (seed % 4 == 3) i.skin_side = -1;
        for (float& c : i.normal_to_camera) c += random.in(-0.1f, 0.1f);
        world.add(mesh, number);
        world.projection.orthographic = orthographic;
        source = world.source();
        layout = surface_layout(m, material, orthographic);
    }
};

TEST_P(WaveSurfaceKernels, SamePlanesOfTriangles) {
    for (std::uint32_t seed = 1; seed < 6; ++seed)
        for (const Place place : kPlaces) {
            Setting s(seed, place, 0);
            for (std::uint32_t count = 0; count < 40; ++count) {
                GuardedArray<std::uint32_t> triangles(count);
                for (std::uint32_t i = 0; i < count; ++i) triangles[i] = s.random.below(s.mesh.triangles());
                GuardedArray<float> got(4 * (std::size_t{count} + kMaxLanes)), want(got.size());
                FlatPlanesJob job{&s.source.instances[0], triangles.data(), count, got.data()};
                traced().flat_planes(job);
                job.planes = want.data();
                one_lane().flat_planes(job);
                ASSERT_TRUE(same_floats(got.data(), want.data(), 4 * std::size_t{count})) << seed << ", " << count;
                ASSERT_FALSE(got.changed());
            }
        }
}

// The corners of a triangle lie in its plane, which is unit and on the front.
TEST_P(WaveSurfaceKernels, PlanesHoldTheirTriangles) {
    Random random(3);
    const KernelMesh mesh(random, Place::kMedium, 100);
    const InstanceView& instance = mesh.instance();
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t t = 0; t < mesh.triangles(); ++t) triangles.push_back(t);
    std::vector<float> planes(4 * (triangles.size() + kMaxLanes));
    traced().flat_planes({&instance, triangles.data(), mesh.triangles(), planes.data()});
    for (const std::uint32_t t : triangles) {
        Real3 p[3];
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = Real3(
                Vec3T<float>::load(instance.mesh.positions + 3 * std::size_t{instance.mesh.triangles[3 * t + k]}));
        const Real3 e1 = p[1] - p[0], e2 = p[2] - p[0], n = outer(e1, e2);
        if (norm(n) < 1e-2L * norm(e1) * norm(e2)) continue;
        const float* plane = &planes[4 * t];
        const Real3 got(Vec3T<float>::load(plane));
        EXPECT_LE(std::fabs(inner(got, unit(n)) - 1), 1e-5L);
        for (const Real3& corner : p) EXPECT_LE(std::fabs(inner(got, corner) - plane[3]), 1e-4L * norm(corner));
    }
}

// What shading reads of the points of a layout; the others keep what was there.
TEST_P(WaveSurfaceKernels, SamePointsOfRays) {
    std::size_t points = 0;
    for (std::uint32_t number = 0; number < KernelWorld::kMaterials; ++number)
        for (const Place place : {Place::kMedium, Place::kMixed, Place::kUnusable, Place::kDegenerate}) {
            Setting s(1 + 7 * number + static_cast<std::uint32_t>(place), place, number);
            for (std::uint32_t count = 1; count < 40; count += 1 + s.random.below(3)) {
                GuardedWave rays(kRayNumbers, 50);
                fill_rays(rays, s.random, count % 2);
                const std::uint32_t first = s.random.below(20);
                GuardedArray<std::uint32_t> ray(count), triangle(count);
                for (std::uint32_t i = 0; i < count; ++i) {
                    ray[i] = s.random.below(50);
                    triangle[i] = s.random.below(s.mesh.triangles());
                }
                GuardedWave got(kPointNumbers, first + count), want(kPointNumbers, got);
                GuardedArray<float> far_got(first + count + kMaxLanes), far_want(far_got.size());
                for (std::size_t i = 0; i < far_got.size(); ++i) far_got[i] = far_want[i] = -7;
                RaySurfacesJob job{&s.source.instances[0],
                                   &s.material,
                                   s.layout,
                                   rays.arrays(),
                                   ray.data(),
                                   triangle.data(),
                                   count,
                                   first,
                                   0.01f,
                                   0.5f,
                                   20,
                                   got.arrays(),
                                   far_got.data()};
                traced().ray_surfaces(job);
                job.points = want.arrays(), job.distance = far_want.data();
                one_lane().ray_surfaces(job);
                ASSERT_TRUE(got.same(want, kPointNumbers, first + count)) << number << ", " << count;
                ASSERT_TRUE(same_floats(far_got.data(), far_want.data(), first + count));
                ASSERT_FALSE(got.changed() || far_got.changed() || rays.changed());
                points += count;
            }
        }
    EXPECT_GT(points, 5000u);
}

TEST_P(WaveSurfaceKernels, SamePointsOfThePicture) {
    std::size_t points = 0;
    for (std::uint32_t number = 0; number < KernelWorld::kMaterials; ++number)
        for (const Place place : {Place::kMedium, Place::kLayers, Place::kMixed})
            for (const bool orthographic : {false, true}) {
                Setting s(2 + 5 * number + static_cast<std::uint32_t>(place), place, number, orthographic);
                std::vector<std::uint32_t> triangles;
                for (std::uint32_t t = 0; t < s.mesh.triangles(); ++t) {
                    TriangleSetup setup;
                    setup_triangle(s.mesh.instance(), t, s.world.projection, setup);
                    if (setup.visible()) triangles.push_back(t);
                }
                if (triangles.empty()) continue;
                const auto seen = static_cast<std::uint32_t>(triangles.size());
                const auto floats = static_cast<std::size_t>(surface_floats(s.layout));
                std::vector<float> padded((seen + kMaxLanes) * floats), flat(4 * (std::size_t{seen} + kMaxLanes));
                tile_kernels(Isa::kScalar)
                    .make_surfaces({&s.source, 0, s.layout, triangles.data(), seen, padded.data()});
                one_lane().flat_planes({&s.source.instances[0], triangles.data(), seen, flat.data()});
                padded.resize(seen * floats), flat.resize(4 * std::size_t{seen});
                const GuardedArray<float> records(padded), planes(flat);
                GuardedArray<std::uint32_t> record_of(seen + 1), plane_of(seen + 1);
                record_of[0] = plane_of[0] = 0;
                for (std::uint32_t i = 0; i < seen; ++i)
                    record_of[i + 1] = static_cast<std::uint32_t>(i * floats), plane_of[i + 1] = 4 * i;
                for (std::uint32_t count = 1; count < 70; count += 1 + s.random.below(5)) {
                    const std::uint32_t padding = (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
                    GuardedArray<std::int32_t> x(padding), y(padding);
                    GuardedArray<std::uint32_t> list(padding);
                    for (std::uint32_t i = 0; i < padding; ++i) {
                        const std::uint32_t same = i < count ? i : count - 1;
                        x[i] = same < i ? x[same] : static_cast<std::int32_t>(s.random.below(KernelMesh::kWidth * 256));
                        y[i] =
                            same < i ? y[same] : static_cast<std::int32_t>(s.random.below(KernelMesh::kHeight * 256));
                        list[i] = same < i ? list[same] : i > 0 && count % 3 ? list[i - 1] : 1 + s.random.below(seen);
                    }
                    const std::uint32_t first = kMaxLanes * s.random.below(2);
                    GuardedWave got(kPointNumbers, first + padding), want(kPointNumbers, got);
                    PrimarySurfacesJob job{};
                    job.source = &s.source;
                    job.material = &s.material;
                    job.layout = s.layout;
                    job.records = records.data(), job.record_of = record_of.data();
                    job.planes = planes.data();
                    job.plane_of = plane_of.data();
                    job.x = x.data(), job.y = y.data(), job.list = list.data();
                    job.count = count, job.first = first;
                    job.width_at_one = 0.01f, job.width = 0.002f;
                    job.points = got.arrays();
                    traced().primary_surfaces(job);
                    job.points = want.arrays();
                    one_lane().primary_surfaces(job);
                    ASSERT_TRUE(got.same(want, kPointNumbers, first + count)) << number << ", " << count;
                    ASSERT_FALSE(got.changed());
                    points += count;
                }
            }
    EXPECT_GT(points, 20000u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, WaveSurfaceKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
