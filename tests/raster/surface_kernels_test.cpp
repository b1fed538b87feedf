// Surface records and shading of every instruction set against one lane.
#include "raster/tile_jobs.h"

namespace tessera {
namespace {

using namespace test;

class SurfaceKernels : public KernelTest {};

// The triangles of a mesh that can be seen.
std::vector<std::uint32_t> visible(const KernelMesh& mesh, const ProjectionView& projection) {
    std::vector<std::uint32_t> list;
    TriangleSetup t;
    for (std::uint32_t i = 0; i < mesh.triangles(); ++i) {
        setup_triangle(mesh.instance(), i, projection, t);
        if (t.visible()) list.push_back(i);
    }
    return list;
}

std::vector<SurfaceLayout> layouts(const KernelMesh& mesh, const KernelWorld& world) {
    std::vector<SurfaceLayout> all;
    for (std::uint32_t m = 0; m < 4; ++m)
        for (int attributes = 0; attributes < 8; ++attributes)
            for (const bool orthographic : {false, true}) {
                MeshView view = mesh.instance().mesh;
                if (!(attributes & 1)) view.colors = nullptr;
                if (!(attributes & 2)) view.tangents = nullptr;
                if (!(attributes & 4)) view.uvs[0] = view.uvs[1] = nullptr;
                const SurfaceLayout l = surface_layout(view, world.material(m), orthographic);
                if (std::find(all.begin(), all.end(), l) == all.end()) all.push_back(l);
            }
    return all;
}

TEST_P(SurfaceKernels, SameRecords) {
    Random random(21);
    std::size_t records = 0;
    for (const Place place : kPlaces)
        for (int round = 0; round < 4; ++round) {
            KernelWorld world(random);
            const KernelMesh mesh(random, place, 2 + random.below(60)), other(random, place, 3);
            world.add(other, 1);
            world.add(mesh, 0, round % 3 == 2);
            const SurfaceSource source = world.source();
            std::vector<std::uint32_t> triangles = visible(mesh, world.projection);
            if (triangles.empty()) continue;
            if (round % 2) triangles.resize(1 + random.below(static_cast<std::uint32_t>(triangles.size())));
            const GuardedArray<std::uint32_t> list(triangles);
            for (const SurfaceLayout& layout : layouts(mesh, world)) {
                const auto floats = static_cast<std::size_t>(surface_floats(layout));
                GuardedArray<float> got((triangles.size() + kMaxLanes) * floats), want(got.size());
                SurfaceJob job{&source,   1, layout, list.data(), static_cast<std::uint32_t>(triangles.size()),
                               got.data()};
                kernels().make_surfaces(job);
                job.records = want.data();
                scalar().make_surfaces(job);
                ASSERT_FALSE(got.changed());
                ASSERT_TRUE(same_floats(got.data(), want.data(), triangles.size() * floats))
                    << "place " << static_cast<int>(place) << ", " << triangles.size() << " triangles, " << layout.count
                    << " planes";
                // One lane again, through the scalar path that the other engines take.
                float record[kMaxSurfaceFloats];
                for (std::size_t i = 0; i < triangles.size(); ++i) {
                    make_one_record(source.instances[1], triangles[i], world.projection, layout, record);
                    ASSERT_TRUE(same_floats(record, &want[i * floats],
                                            static_cast<std::size_t>(kSurfaceHeader + 3 * layout.count)))
                        << "triangle " << triangles[i];
                }
                records += triangles.size();
            }
        }
    EXPECT_GT(records, 5000u);
}

// Records of one instance, and who shows them.
struct ShadeSetting {
    Random random;
    KernelWorld world;
    KernelMesh mesh;
    SurfaceSource source;
    SurfaceLayout layout;
    std::vector<float> records;
    std::vector<std::uint32_t> record_of{0};
    std::uint32_t seen = 0;  // ordinals 1 .. seen

    ShadeSetting(std::uint32_t seed, std::uint32_t material, bool bare)
        : random(seed), world(random), mesh(random, Place::kMedium, 40) {
        // The layouts that have code of their own come from meshes with few attributes.
        if (bare) {
            MeshView& m = mesh.instance().mesh;
            m.tangents = nullptr;
            m.uvs[1] = nullptr;
            if (world.material(material).model != ShadingModel::kUnlit) m.colors = nullptr;
        }
        world.add(mesh, material);
        source = world.source();
        layout = surface_layout(source.instances[0].mesh, world.material(material), false);
        const std::vector<std::uint32_t> triangles = visible(mesh, world.projection);
        const auto floats = static_cast<std::size_t>(surface_floats(layout));
        records.resize((triangles.size() + kMaxLanes) * floats);
        const SurfaceJob job{&source,       0, layout, triangles.data(), static_cast<std::uint32_t>(triangles.size()),
                             records.data()};
        tile_kernels(Isa::kScalar).make_surfaces(job);
        seen = static_cast<std::uint32_t>(triangles.size());
        for (std::uint32_t i = 0; i < seen; ++i) record_of.push_back(static_cast<std::uint32_t>(i * floats));
        records.resize(triangles.size() * floats);
    }
    ShadeJob job(std::uint32_t material) {
        ShadeJob j{};
        j.source = &source;
        j.material = &world.material(material);
        j.layout = layout;
        j.records = records.data();
        j.record_of = record_of.data();
        return j;
    }
    std::uint32_t ordinal() { return 1 + random.below(seen); }
};

struct Planes {
    GuardedArray<float> r, g, b, alpha;
    explicit Planes(std::size_t count) : r(count), g(count), b(count), alpha(count) {
        for (GuardedArray<float>* p : {&r, &g, &b, &alpha})
            for (std::size_t i = 0; i < count; ++i) (*p)[i] = 0.25f * static_cast<float>(i % 7);
    }
    void point(ShadeJob& job) {
        job.r = r.data();
        job.g = g.data();
        job.b = b.data();
        job.alpha = alpha.data();
    }
};

void expect_same(const Planes& a, const Planes& b, std::size_t count, const std::string& what) {
    ASSERT_FALSE(a.r.changed() || a.g.changed() || a.b.changed() || a.alpha.changed()) << what;
    ASSERT_TRUE(same_floats(a.r.data(), b.r.data(), count)) << what << ", red";
    ASSERT_TRUE(same_floats(a.g.data(), b.g.data(), count)) << what << ", green";
    ASSERT_TRUE(same_floats(a.b.data(), b.b.data(), count)) << what << ", blue";
    ASSERT_TRUE(same_floats(a.alpha.data(), b.alpha.data(), count)) << what << ", alpha";
}

// Tiles that show nothing, one triangle, few per vector, and another one at every pixel.
constexpr int kPatterns = 6;
void show(ShadeSetting& s, int pattern, GuardedArray<std::uint32_t>& ordinal) {
    const std::uint32_t one = s.ordinal();
    std::uint32_t run = one;
    for (std::size_t i = 0; i < ordinal.size(); ++i) {
        if (s.random.below(pattern == 3 ? 3 : 40) == 0) run = s.random.below(3) ? s.ordinal() : 0;
        ordinal[i] = pattern == 0 ? 0 : pattern == 1 ? one : pattern == 2 ? s.ordinal() : run;
        if (pattern == 5 && s.random.below(9)) ordinal[i] = 0;
    }
}

// Calls test(setting, job, what) with jobs of every material, layout and pattern, still without planes.
template <class Test>
void for_each_shaded_tile(Test&& test) {
    for (std::uint32_t material = 0; material < KernelWorld::kMaterials; ++material)
        for (const bool bare : {false, true}) {
            ShadeSetting s(30 + material, material, bare);
            ASSERT_GT(s.seen, 8u);
            for (int pattern = 0; pattern < kPatterns; ++pattern) {
                ShadeJob job = s.job(material);
                job.side = 32 << pattern % 3;
                job.x0 = job.side;
                job.offset = {static_cast<std::int32_t>(s.random.below(256)), 77};
                GuardedArray<std::uint32_t> ordinal(tile_pixels(job.side));
                show(s, pattern, ordinal);
                job.ordinal = ordinal.data();
                test(s, job, "material " + std::to_string(material) + ", pattern " + std::to_string(pattern));
                if (testing::Test::HasFatalFailure()) return;
            }
        }
}

struct Hits {
    GuardedArray<std::uint64_t> blocks;
    explicit Hits(int side) : blocks(tile_pixels(side) / kBlockPixels) {
        for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = i << 60;
    }
};

TEST_P(SurfaceKernels, SameShadesOfATile) {
    for_each_shaded_tile([&](const ShadeSetting&, ShadeJob job, const std::string& what) {
        for (const bool first : {true, false}) {
            job.first = first;
            const std::size_t pixels = tile_pixels(job.side);
            Planes got(pixels), want(pixels);
            Hits hit_got(job.side), hit_want(job.side);
            got.point(job);
            job.hit = hit_got.blocks.data();
            kernels().shade_tile(job);
            want.point(job);
            job.hit = hit_want.blocks.data();
            scalar().shade_tile(job);
            expect_same(got, want, pixels, what);
            ASSERT_TRUE(same_bytes(hit_got.blocks, hit_want.blocks));
            ASSERT_FALSE(hit_got.blocks.changed());
        }
    });
}

// One sample a pixel, developed as it is shaded: the same pixels on one lane, and by way of the sums.
TEST_P(SurfaceKernels, SamePixelsOfATileDevelopedAtOnce) {
    for_each_shaded_tile([&](ShadeSetting& s, ShadeJob job, const std::string& what) {
        const auto part = [&] {
            const auto side = static_cast<std::uint32_t>(job.side);
            return s.random.below(2) ? job.side : 1 + static_cast<int>(s.random.below(side));
        };
        DevelopJob film{};
        film.film = {
            0.8f, static_cast<ToneMap>(s.random.below(3)), {0.2f, 0.4f, 0.1f, s.random.below(2) ? 1.0f : 0.0f}};
        film.film.encoding = s.random.below(2) ? Encoding::kSrgb : Encoding::kLinear;
        film.weight = 1;
        film.window = {job.side, part(), part(), 0, s.random.below(2) == 0};
        using Pixels = Window<std::uint32_t>;
        const auto w = static_cast<std::size_t>(film.window.width), h = static_cast<std::size_t>(film.window.height);
        const auto window = [&] { return film.window.streamed ? Pixels::on_lines(w, h) : Pixels(w, h, 11); };
        Pixels got = window(), want = window(), summed = window();
        film.window.stride = 4 * got.stride;
        const auto develop_into = [&](Pixels& p) { film.rgba = reinterpret_cast<std::uint8_t*>(p.pixels.data()); };
        Hits hit_got(job.side), hit_want(job.side);
        job.first = true;
        job.develop = &film;
        develop_into(got);
        job.hit = hit_got.blocks.data();
        kernels().shade_tile(job);
        develop_into(want);
        job.hit = hit_want.blocks.data();
        scalar().shade_tile(job);
        ASSERT_TRUE(same_bytes(got.pixels, want.pixels)) << what;
        ASSERT_TRUE(same_bytes(hit_got.blocks, hit_want.blocks)) << what;
        ASSERT_FALSE(got.gaps_changed() || want.gaps_changed() || hit_got.blocks.changed()) << what;

        Planes sums(tile_pixels(job.side));
        job.develop = nullptr;
        sums.point(job);
        kernels().shade_tile(job);
        film.r = sums.r.data();
        film.g = sums.g.data();
        film.b = sums.b.data();
        film.alpha = sums.alpha.data();
        develop_into(summed);
        kernels().develop(film);
        ASSERT_TRUE(same_bytes(got.pixels, summed.pixels)) << what;
    });
}

TEST_P(SurfaceKernels, SameShadesOfPoints) {
    for (std::uint32_t material = 0; material < KernelWorld::kMaterials; ++material) {
        ShadeSetting s(50 + material, material, material % 2 == 0);
        // 256 at a time.
        std::vector<std::uint32_t> counts{255, 256, 257, 300, 513};
        for (std::uint32_t count = 1; count < 40; ++count) counts.push_back(count);
        for (const std::uint32_t count : counts) {
            const std::size_t padded = count + kMaxLanes;
            GuardedArray<std::int32_t> x(padded), y(padded);
            GuardedArray<std::uint32_t> list(padded);
            for (std::size_t i = 0; i < padded; ++i) {
                x[i] = i < count ? static_cast<std::int32_t>(s.random.below(KernelMesh::kWidth * 256)) : x[count - 1];
                y[i] = i < count ? static_cast<std::int32_t>(s.random.below(KernelMesh::kHeight * 256)) : y[count - 1];
                list[i] = i < count ? (count % 3 && i > 0 ? list[i - 1] : s.ordinal()) : list[count - 1];
            }
            ShadeJob job = s.job(material);
            job.x = x.data();
            job.y = y.data();
            job.list = list.data();
            job.count = count;
            Planes got(padded), want(padded);
            got.point(job);
            kernels().shade_points(job);
            want.point(job);
            scalar().shade_points(job);
            expect_same(got, want, count, "material " + std::to_string(material) + ", " + std::to_string(count));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kernels, SurfaceKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
