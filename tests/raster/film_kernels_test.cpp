// What is seen of a tile, developing it and its labels: every instruction set against one lane, nothing
// written outside the part of the picture that the tile covers.
#include "raster/tile_jobs.h"

namespace tessera {
namespace {

using namespace test;

class FilmKernels : public KernelTest {};

TEST_P(FilmKernels, FindVisible) {
    Random random(71);
    for (int round = 0; round < 400; ++round) {
        const int side = 32 << round % 3;
        const std::uint32_t count = round % 5 == 0 ? 1 : 1 + random.below(3000);
        GuardedArray<std::uint32_t> ordinal(tile_pixels(side));
        std::uint32_t now = 0;
        const std::uint32_t change = 1 + random.below(200);
        for (std::size_t i = 0; i < ordinal.size(); ++i) {
            if (random.below(change) == 0) now = random.below(count + 1);
            ordinal[i] = now;
        }
        if (round % 7 == 0) ordinal[ordinal.size() - 1] = count;  // the last lane, the last ordinal
        GuardedArray<std::uint8_t> seen_got(count + 1), seen_want(count + 1);
        GuardedArray<std::uint32_t> list_got(count + 1), list_want(count + 1);
        VisibleJob got{ordinal.data(), side * side, count, seen_got.data(), list_got.data(), 0}, want = got;
        want.seen = seen_want.data();
        want.list = list_want.data();
        kernels().find_visible(got);
        scalar().find_visible(want);
        ASSERT_EQ(got.count, want.count);
        ASSERT_EQ(std::memcmp(got.list, want.list, got.count * sizeof(std::uint32_t)), 0);
        for (std::uint32_t i = 1; i <= count; ++i) ASSERT_EQ(seen_got[i], seen_want[i]) << i;
        ASSERT_FALSE(seen_got.changed() || list_got.changed());
        // By definition: every ordinal that occurs, once, in order.
        std::vector<std::uint32_t> all(ordinal.data(), ordinal.data() + ordinal.size());
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        if (all.front() == 0) all.erase(all.begin());
        ASSERT_EQ(std::vector<std::uint32_t>(got.list, got.list + got.count), all);
    }
}

TEST_P(FilmKernels, Develop) {
    Random random(72);
    constexpr float kOdd[] = {0.0f,
                              -0.0f,
                              1.0f,
                              -1.0f,
                              1e-42f,
                              3e38f,
                              std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN()};
    for (int round = 0; round < 200; ++round) {
        const int side = 32 << round % 3;
        const int width = round % 2 ? side : 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(side)));
        const int height = round % 4 < 2 ? side : 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(side)));
        const float samples = static_cast<float>(1 + random.below(8));
        DevelopJob job{};
        job.film = {random.in(0.1f, 3), static_cast<ToneMap>(round % 3), {0.2f, 0.4f, 0.1f, round % 5 ? 1.0f : 0.0f}};
        job.film.encoding = round % 7 ? Encoding::kSrgb : Encoding::kLinear;
        job.weight = 1 / samples;
        job.window = {side, width, height, 0, round % 32 < 16};
        GuardedArray<float> planes[4] = {GuardedArray<float>(tile_pixels(side)), GuardedArray<float>(tile_pixels(side)),
                                         GuardedArray<float>(tile_pixels(side)),
                                         GuardedArray<float>(tile_pixels(side))};
        const bool odd = round % 3 == 1, whole = round % 5 == 1;
        for (std::size_t i = 0; i < planes[0].size(); ++i) {
            planes[3][i] = whole ? samples : static_cast<float>(random.below(static_cast<std::uint32_t>(samples) + 1));
            for (int c = 0; c < 3; ++c)
                planes[c][i] = planes[3][i] == 0 ? 0 : random.in(0, random.below(4) ? 1.0f : 20.0f) * planes[3][i];
            if (odd && random.below(8) == 0) planes[random.below(4)][i] = kOdd[random.below(std::size(kOdd))];
        }
        job.r = round % 16 == 0 ? nullptr : planes[0].data();  // without sums: the background
        job.g = planes[1].data();
        job.b = planes[2].data();
        job.alpha = planes[3].data();
        const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
        using Pixels = Window<std::uint32_t>;
        const std::size_t gap = random.below(40);
        const auto window = [&] { return job.window.streamed ? Pixels::on_lines(w, h) : Pixels(w, h, gap); };
        Pixels got = window(), want = window();
        job.window.stride = 4 * got.stride;
        job.rgba = reinterpret_cast<std::uint8_t*>(got.pixels.data());
        kernels().develop(job);
        job.rgba = reinterpret_cast<std::uint8_t*>(want.pixels.data());
        scalar().develop(job);
        ASSERT_TRUE(same_bytes(got.pixels, want.pixels)) << round;
        ASSERT_FALSE(got.gaps_changed() || want.gaps_changed()) << round;
    }
}

TEST_P(FilmKernels, Labels) {
    Random random(73);
    const KernelWorld world(random);
    std::vector<InstanceView> instances(3);
    for (std::uint32_t i = 0; i < 3; ++i) {
        instances[i].first_triangle = 1000 * i;
        instances[i].node = 70 + i;
        instances[i].scene_material = 5 - i;
        instances[i].first_primitive = 2000 * i;
    }
    for (int round = 0; round < 120; ++round) {
        const int side = 32 << round % 3;
        const int width = round % 2 ? side : 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(side)));
        const int height = round % 4 < 2 ? side : 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(side)));
        GuardedArray<TileTriangle> triangles(1 + random.below(500));
        for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = {random.below(1000), random.below(3)};
        GuardedArray<float> depth(tile_pixels(side));
        GuardedArray<std::uint32_t> ordinal(tile_pixels(side));
        for (std::size_t i = 0; i < depth.size(); ++i) {
            depth[i] = random.below(20) ? random.in(0, 1) : 1e-38f;
            ordinal[i] = random.below(2) ? random.below(static_cast<std::uint32_t>(triangles.size()) + 1) : 0;
        }
        LabelJob job{};
        job.projection = world.projection;
        job.projection.orthographic = round % 5 == 0;
        job.projection.clip_from_camera[10] = round % 5 == 0 ? 0.1f : 0.01f;
        job.window = {side, width, height, 0, round % 8 < 4};
        job.x0 = side * (round % 5);
        job.y0 = side * (round % 7);
        job.euclidean = round % 2 == 0;
        job.depth = depth.data();
        job.ordinal = round % 11 ? ordinal.data() : nullptr;  // without: a tile that shows nothing
        job.triangles = triangles.data();
        job.instances = instances.data();
        const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
        const auto window = [&]<class T>(T) {
            return job.window.streamed ? Window<T>::on_lines(w, h) : Window<T>(w, h, 9);
        };
        struct Planes {
            Window<float> distance;
            Window<std::uint32_t> triangle, primitive, node, material;
        };
        const auto planes = [&] { return Planes{window(0.0f), window(0u), window(0u), window(0u), window(0u)}; };
        Planes got = planes(), want = planes();
        job.window.stride = 4 * got.node.stride;
        const bool with_distance = round % 3 != 1, with_numbers = round % 3 != 2;
        const auto run = [&](const Kernels& k, Planes& p) {
            job.planes.distance = with_distance ? p.distance.pixels.data() : nullptr;
            job.planes.triangle = with_numbers ? p.triangle.pixels.data() : nullptr;
            job.planes.primitive = with_numbers ? p.primitive.pixels.data() : nullptr;
            job.planes.node = with_numbers ? p.node.pixels.data() : nullptr;
            job.planes.material = with_numbers ? p.material.pixels.data() : nullptr;
            k.label(job);
        };
        run(kernels(), got);
        run(scalar(), want);
        ASSERT_TRUE(same_bytes(got.distance.pixels, want.distance.pixels)) << round;
        ASSERT_FALSE(got.distance.gaps_changed()) << round;
        for (auto plane : {&Planes::triangle, &Planes::primitive, &Planes::node, &Planes::material}) {
            ASSERT_TRUE(same_bytes((got.*plane).pixels, (want.*plane).pixels)) << round;
            ASSERT_FALSE((got.*plane).gaps_changed()) << round;
        }
        const PictureRays rays(job.projection);
        for (int y = 0; y < height; ++y)  // by definition
            for (int x = 0; x < width; ++x) {
                const std::size_t place = place_of(x, y, side);
                const std::uint32_t o = job.ordinal ? ordinal[place] : 0;
                const std::size_t at = static_cast<std::size_t>(y) * got.node.stride + static_cast<std::size_t>(x);
                const TileTriangle t = o == 0 ? TileTriangle{0, 0} : triangles[o - 1];
                if (with_numbers) {
                    ASSERT_EQ(got.triangle.pixels[at], o == 0 ? 0 : 1000 * t.instance + t.triangle + 1);
                    ASSERT_EQ(got.primitive.pixels[at], o == 0 ? 0 : 2000 * t.instance + t.triangle + 1);
                    ASSERT_EQ(got.node.pixels[at], o == 0 ? 0 : 71 + t.instance);
                    ASSERT_EQ(got.material.pixels[at], o == 0 ? 0 : 6 - t.instance);
                }
                if (!with_distance) continue;
                float distance = std::numeric_limits<float>::infinity();
                if (o != 0) distance = distance_of_depth(job.projection, depth[place]);
                if (o != 0 && job.euclidean)
                    distance = euclidean_distance(rays, distance, static_cast<float>(256 * (job.x0 + x) + 128),
                                                  static_cast<float>(256 * (job.y0 + y) + 128));
                ASSERT_EQ(got.distance.pixels[at], distance) << round;
            }
    }
}

INSTANTIATE_TEST_SUITE_P(Kernels, FilmKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
