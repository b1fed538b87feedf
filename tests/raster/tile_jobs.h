// A tile's job in the hands of a kernel test: arrays of exactly the documented size, which end where
// memory ends.
#pragma once

#include "raster/kernel_world.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace tessera::test {

inline std::size_t tile_pixels(int side) { return static_cast<std::size_t>(side) * static_cast<std::size_t>(side); }

// The place of a pixel in the arrays of a tile: blocks of 8x8.
inline std::size_t place_of(int x, int y, int side) {
    return static_cast<std::size_t>((y / 8 * (side / 8) + x / 8) * 64 + y % 8 * 8 + x % 8);
}

// The triangles of several instances for one tile, in two chunks.
class TileScene {
  public:
    TileScene(Random& random, KernelWorld& world, const std::vector<std::unique_ptr<KernelMesh>>& meshes,
              const SetupOptions& options)
        : options_(options) {
        for (std::uint32_t i = 0; i < meshes.size(); ++i) {
            const std::uint32_t material = random.below(KernelWorld::kMaterials);
            world.add(*meshes[i], material);
            SetupOptions o = options;
            o.masks = o.one_sample && world.material(material).alpha_mode == AlphaMode::kOpaque;
            set_up(raster_kernels(Isa::kScalar), *meshes[i], i, o, chunks_[2 * i >= meshes.size()]);
        }
    }
    // The tile's runs, sorted; how many triangles they are.
    std::uint32_t bin(std::uint32_t tile) {
        std::uint32_t triangles = 0;
        bins.clear();
        for (int c = 0; c < 2; ++c) {
            runs_[c].clear();
            for (std::size_t r = 0; r < chunks_[c].runs.size(); ++r)
                if (chunks_[c].run_tiles[r] == tile) {
                    runs_[c].push_back(chunks_[c].runs[r]);
                    triangles += runs_[c].back().size();
                }
            if (!runs_[c].empty())
                bins.push_back({chunks_[c].small.data(), chunks_[c].large.data(), runs_[c].data(),
                                static_cast<std::uint32_t>(runs_[c].size())});
        }
        return triangles;
    }
    int columns() const { return (KernelMesh::kWidth + options_.tile_side - 1) / options_.tile_side; }
    int rows() const { return (KernelMesh::kHeight + options_.tile_side - 1) / options_.tile_side; }

    std::vector<TileBin> bins;

  private:
    SetupOptions options_;
    SetupResult chunks_[2];
    std::vector<BinRun> runs_[2];
};

// Everything that visibility writes.
struct VisibilityRun {
    struct Fragment {
        std::uint32_t pixel, ordinal;
        float depth;
    };
    GuardedArray<float> depth, floor;
    GuardedArray<std::uint32_t> ordinal, overdraw;
    GuardedArray<TileTriangle> triangles;
    std::vector<Fragment> fragments;
    TileCounters counters;

    VisibilityRun(int side, std::uint32_t triangle_count)
        : depth(tile_pixels(side)),
          floor(tile_pixels(side) / kBlockPixels),
          ordinal(tile_pixels(side)),
          overdraw(tile_pixels(side)),
          triangles(triangle_count) {}

    // Far everywhere, and infinitely near outside `width` x `height`.
    void clear(int side, int width, int height) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                depth[place_of(x, y, side)] = x < width && y < height ? 0.0f : std::numeric_limits<float>::infinity();
        for (std::size_t b = 0; b < floor.size(); ++b)
            floor[b] = *std::min_element(&depth[b * kBlockPixels], &depth[b * kBlockPixels] + kBlockPixels);
        std::fill_n(ordinal.data(), ordinal.size(), 0u);
        std::fill_n(overdraw.data(), overdraw.size(), 0u);
    }
    void run(const RasterKernels& kernels, VisibilityJob job) {
        job.depth = depth.data();
        job.ordinal = ordinal.data();
        job.floor = floor.data();
        job.triangles = triangles.data();
        if (job.overdraw) job.overdraw = overdraw.data();
        job.owner = this;
        job.add_fragment = [](void* owner, std::uint32_t pixel, std::uint32_t ordinal_, float z) {
            static_cast<VisibilityRun*>(owner)->fragments.push_back({pixel, ordinal_, z});
        };
        kernels.visibility(job);
        counters = job.counters;
    }
    bool wrote_before() const {
        return depth.changed() || floor.changed() || ordinal.changed() || overdraw.changed() || triangles.changed();
    }
};

template <class T>
bool same_bytes(const GuardedArray<T>& a, const GuardedArray<T>& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

// A part of a picture: rows of `width` pixels, `stride` apart; the last one ends where memory ends.
template <class T>
struct Window {
    GuardedArray<T> pixels;
    std::size_t stride, width, height;

    Window(std::size_t w, std::size_t h, std::size_t gap) : Window(w, h, gap, (h - 1) * (w + gap) + w) {}
    // Every row begins on a cache line, as streams need it.
    static Window on_lines(std::size_t w, std::size_t h) {
        const std::size_t line = 64 / sizeof(T), stride = (w + line) / line * line;
        return {w, h, stride - w, h * stride};
    }
    bool gaps_changed() const {
        std::vector<T> untouched(1);
        std::memset(untouched.data(), 0x5a, sizeof(T));
        for (std::size_t i = 0; i < pixels.size(); ++i)
            if (i % stride >= width && std::memcmp(&pixels[i], untouched.data(), sizeof(T)) != 0) return true;
        return pixels.changed();
    }

  private:
    Window(std::size_t w, std::size_t h, std::size_t gap, std::size_t size)
        : pixels(size), stride(w + gap), width(w), height(h) {
        std::memset(pixels.data(), 0x5a, pixels.size() * sizeof(T));
    }
};

}  // namespace tessera::test
