// Memory of a frame beyond the scene: at most 150 bytes per visible triangle and 40 per pixel, the picture
// included. Measured, not estimated: this program's operator new counts.
#include "cli/workloads.h"
#include "raster/engine.h"
#include "reference/workload_scene.h"
#include "simd/isa.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::int64_t> live{0}, peak{0};

void* count_in(void* p) {
    if (!p) throw std::bad_alloc();
    const std::int64_t now = live += static_cast<std::int64_t>(malloc_usable_size(p));
    std::int64_t highest = peak.load();
    while (highest < now && !peak.compare_exchange_weak(highest, now)) {
    }
    return p;
}
void count_out(void* p) {
    if (!p) return;
    live -= static_cast<std::int64_t>(malloc_usable_size(p));
    std::free(p);
}
void* aligned(std::size_t size, std::align_val_t alignment) {
    const auto a = static_cast<std::size_t>(alignment);
    return std::aligned_alloc(a, (size + a - 1) / a * a);
}

}  // namespace

void* operator new(std::size_t size) { return count_in(std::malloc(size ? size : 1)); }
void* operator new[](std::size_t size) { return count_in(std::malloc(size ? size : 1)); }
void* operator new(std::size_t size, std::align_val_t a) { return count_in(aligned(size, a)); }
void* operator new[](std::size_t size, std::align_val_t a) { return count_in(aligned(size, a)); }
void operator delete(void* p) noexcept { count_out(p); }
void operator delete[](void* p) noexcept { count_out(p); }
void operator delete(void* p, std::size_t) noexcept { count_out(p); }
void operator delete[](void* p, std::size_t) noexcept { count_out(p); }
void operator delete(void* p, std::align_val_t) noexcept { count_out(p); }
void operator delete[](void* p, std::align_val_t) noexcept { count_out(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { count_out(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { count_out(p); }

namespace tessera {
namespace {

constexpr int kWidth = 1920, kHeight = 1080;

class RasterMemory : public testing::TestWithParam<const char*> {};

TEST_P(RasterMemory, CARD8_BytesPerVisibleTriangleAndPixel) {
    cli::Workload w = cli::make_workload(GetParam(), kWidth, kHeight);
    const test::Prepared p(std::move(w.scene), w.options.view, kWidth, kHeight);
    for (const int threads : {1, 2}) {
        Arena arena(threads);
        RasterSettings settings;
        settings.samples = {{128, 128}};
        settings.film = p.shading->film(w.options);
        settings.isa = resolve_isa(Isa::kAuto);
        settings.max_fragments = 1 << 20;
        settings.checkpoint = [](double) {};
        const std::int64_t before = live;
        peak = before;
        std::vector<std::uint8_t> rgba(std::size_t{4} * kWidth * kHeight);
        PictureTargets targets;
        targets.rgba = rgba.data();
        RasterEngine engine;
        const RasterCounters counters = engine.draw(p.frame, p.context(), settings, targets, arena);
        const std::int64_t used = peak - before;
        EXPECT_EQ(cli::pixel_fault(w, counters.pixels_covered), "");
        const auto visible = static_cast<std::int64_t>(counters.front.small + counters.front.large);
        EXPECT_GT(visible, 100000);
        constexpr std::int64_t kPixels = std::int64_t{kWidth} * kHeight;
        const std::int64_t allowed = 150 * visible + 40 * kPixels;
        EXPECT_LE(used, allowed);
        std::printf("%s, %d threads: %.1f MB of %.1f; beside the picture %.0f bytes per triangle that is drawn\n",
                    GetParam(), threads, static_cast<double>(used) * 1e-6, static_cast<double>(allowed) * 1e-6,
                    static_cast<double>(used - 4 * kPixels) / static_cast<double>(visible));
        // Later frames use the same memory again.
        const std::int64_t warm = live;
        peak = warm;
        engine.draw(p.frame, p.context(), settings, targets, arena);
        EXPECT_LE(peak - warm, std::int64_t{4} << 20);
    }
}

INSTANTIATE_TEST_SUITE_P(Workloads, RasterMemory, testing::Values("terrain1m", "sphere1m"),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace tessera
