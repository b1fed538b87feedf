// BEY2: labels of the surface, every instruction set against one lane and against the surface function itself.
#include "raster/tile_jobs.h"

#include "shading/label_point.h"

namespace tessera {
namespace {

using namespace test;

class LabelKernels : public KernelTest {};

constexpr float kTurned[12] = {0, 1, 0, 2, -1, 0, 0, 3, 0, 0, 1, 4};

struct Planes {
    GuardedArray<float> normal, shading_normal, position, albedo, uv;

    explicit Planes(std::size_t pixels)
        : normal(3 * pixels), shading_normal(3 * pixels), position(3 * pixels), albedo(3 * pixels), uv(2 * pixels) {
        for (GuardedArray<float>* p : {&normal, &shading_normal, &position, &albedo, &uv})
            for (std::size_t i = 0; i < p->size(); ++i) (*p)[i] = 0.25f * static_cast<float>(i % 7);
    }
    void point(LabelSurfaceJob& job) {
        job.planes.normal = job.labels.normal ? normal.data() : nullptr;
        job.planes.shading_normal = job.labels.shading_normal ? shading_normal.data() : nullptr;
        job.planes.position = job.labels.position ? position.data() : nullptr;
        job.planes.albedo = job.labels.albedo ? albedo.data() : nullptr;
        job.planes.uv = job.labels.uv ? uv.data() : nullptr;
    }
};

void expect_same(const Planes& a, const Planes& b, const std::string& what) {
    for (const auto plane :
         {&Planes::normal, &Planes::shading_normal, &Planes::position, &Planes::albedo, &Planes::uv}) {
        ASSERT_FALSE((a.*plane).changed()) << what;
        ASSERT_TRUE(same_bytes(a.*plane, b.*plane)) << what;
    }
}

// The surface function at one pixel, beside what the kernel wrote there.
void expect_by_definition(const LabelSurfaceJob& job, const Planes& planes, int x, int y, const std::string& what) {
    const std::uint32_t o = job.ordinal[place_of(x, y, job.side)];
    const std::size_t at = static_cast<std::size_t>(y) * job.picture_width + static_cast<std::size_t>(x);
    if (o == 0) {
        EXPECT_EQ(planes.uv[2 * at], 0.25f * static_cast<float>(2 * at % 7)) << what << ": a miss was written";
        return;
    }
    const float* const record = job.records + job.record_of[o];
    const float px = static_cast<float>(256 * (job.x0 + x) + 128), py = static_cast<float>(256 * (job.y0 + y) + 128);
    SurfaceSample<float> sample;
    sample_planes(
        job.layout, px, py, [record](int i) { return record[i]; }, sample);
    SurfacePoint<float> s = surface_point(job.layout, PictureRays(job.source->projection), sample, px, py, 1.0f);
    s.position = position_of_depth(job.source->projection, PictureRays(job.source->projection),
                                   job.depth[place_of(x, y, job.side)], px, py);
    const LabelPoint<float> p = label_point(job.labels, job.layout, *job.material, kTurned, s);
    const auto same = [&](const GuardedArray<float>& plane, const Vec3T<float>& v) {
        const float numbers[3] = {v.x, v.y, v.z};
        EXPECT_TRUE(same_floats(&plane[3 * at], numbers, 3)) << what;
    };
    if (job.labels.normal) same(planes.normal, p.normal);
    if (job.labels.shading_normal) same(planes.shading_normal, p.shading_normal);
    if (job.labels.position) same(planes.position, p.position);
    if (job.labels.albedo) same(planes.albedo, p.albedo);
    const float uv[2] = {p.uv.x, p.uv.y};
    if (job.labels.uv) {
        EXPECT_TRUE(same_floats(&planes.uv[2 * at], uv, 2)) << what;
    }
}

TEST_P(LabelKernels, BEY2_SameLabelsOfASurface) {
    for (std::uint32_t material = 0; material < KernelWorld::kMaterials; ++material)
        for (unsigned wanted = 1; wanted < 32; wanted += material % 2 ? 5 : 3) {
            Random random(100 * material + wanted);
            KernelWorld world(random);
            KernelMesh mesh(random, Place::kMedium, 40);
            world.add(mesh, material);
            const SurfaceSource source = world.source();
            LabelSurfaceJob job{};
            job.labels = {(wanted & 1) != 0, (wanted & 2) != 0, (wanted & 4) != 0, (wanted & 8) != 0,
                          (wanted & 16) != 0};
            job.source = &source;
            job.material = &world.material(material);
            job.layout = label_layout(source.instances[0].mesh, *job.material, job.labels, false);
            std::vector<std::uint32_t> triangles;
            TriangleSetup t;
            for (std::uint32_t i = 0; i < mesh.triangles(); ++i) {
                setup_triangle(mesh.instance(), i, world.projection, t);
                if (t.visible()) triangles.push_back(i);
            }
            const auto floats = static_cast<std::size_t>(surface_floats(job.layout));
            std::vector<float> records((triangles.size() + kMaxLanes) * floats);
            scalar().make_surfaces({&source, 0, job.layout, triangles.data(),
                                    static_cast<std::uint32_t>(triangles.size()), records.data()});
            std::vector<std::uint32_t> record_of{0};
            for (std::size_t i = 0; i < triangles.size(); ++i)
                record_of.push_back(static_cast<std::uint32_t>(i * floats));
            job.records = records.data();
            job.record_of = record_of.data();
            job.side = 32 << wanted % 3;
            job.x0 = job.side;
            job.y0 = 0;
            job.label_from_camera = kTurned;
            job.picture_width = static_cast<std::size_t>(job.side) + wanted % 4;
            GuardedArray<std::uint32_t> ordinal(tile_pixels(job.side));
            std::uint32_t run = 0;
            for (std::size_t i = 0; i < ordinal.size(); ++i) {
                if (random.below(wanted % 2 ? 20 : 2) == 0)
                    run = random.below(4) ? 1 + random.below(static_cast<std::uint32_t>(triangles.size())) : 0;
                ordinal[i] = run;
            }
            job.ordinal = ordinal.data();
            GuardedArray<float> depth(ordinal.size());
            for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = 0.01f + 0.001f * static_cast<float>(i % 97);
            job.depth = depth.data();
            const std::size_t pixels =
                job.picture_width * static_cast<std::size_t>(job.side - 1) + static_cast<std::size_t>(job.side);
            Planes got(pixels), want(pixels);
            got.point(job);
            kernels().label_surfaces(job);
            want.point(job);
            scalar().label_surfaces(job);
            const std::string what = "material " + std::to_string(material) + ", labels " + std::to_string(wanted);
            expect_same(got, want, what);
            if (HasFatalFailure()) return;
            for (int i = 0; i < 200; ++i) {
                const auto side = static_cast<std::uint32_t>(job.side);
                const int x = static_cast<int>(random.below(side));
                expect_by_definition(job, got, x, static_cast<int>(random.below(side)), what);
                if (HasFailure()) return;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Kernels, LabelKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
