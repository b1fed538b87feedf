// Visible samples to radiance and on to the picture, in three stages that hand each other some blocks of
// points: surfaces (point_kernel.h), materials and lights, film or sums. All of it through the templates
// that the reference uses with plain numbers. Part of a kernel file, once per instruction set.
#pragma once

#include "tile/point_kernel.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// Points as a batch of shading.
template <class Layout>
struct PointBatch {
    static constexpr int kCount = kVectors;
    static constexpr bool kColored = Layout::kColored;
    const SurfaceLayout& layout;
    const PictureRays rays;
    const Points& points;

    TESSERA_INLINE bool used(int k) const { return points.used[k] != 0; }
    TESSERA_INLINE Vec3T<Float> position(int k) const {
        return eye(k).position(layout.depth >= 0, points.surface[k][0]);
    }
    TESSERA_INLINE Vec3T<Float> view(int k) const { return eye(k).view(layout.depth >= 0, points.surface[k][1]); }
    TESSERA_INLINE Vec3T<Float> normal(int k) const {
        const Float* n = points.surface[k] + 2;
        return {n[0], n[1], n[2]};
    }
    TESSERA_INLINE SurfacePoint<Float> point(int k) const { return load_point(layout, eye(k), points.surface[k]); }

  private:
    TESSERA_INLINE EyeDirection<Float> eye(int k) const { return {rays, points.x[k], points.y[k]}; }
};

// From Points::surface to radiance and alpha.
template <class Layout, ShadingFamily kFamily, int kUvSets>
__attribute__((noinline)) void shade_surfaces(const ShadeConstants& constants, Points& points) {
    // Copies, which no store can change.
    const ShadingContext context = constants.context;
    const MaterialView material = constants.material;
    const PointBatch<Layout> batch{Layout::layout(constants.job), constants.rays, points};
    shade_as<kFamily, kUvSets>(
        context, material, batch, [](int, const LightSample<Float>&, int) { return Unshadowed{}; }, points.shaded);
}

// The stages for a job: those that know its layout and family beforehand have less code.
struct Stages {
    void (*find)(const ShadeConstants& constants, Points& points);
    void (*shade)(const ShadeConstants& constants, Points& points);

    explicit Stages(const ShadeConstants& constants) {
        using enum ShadingFamily;
        // That the material may name; what it mirrors is read by the code for all of them.
        int uv_sets = has_specular_texture(constants.material) ? kMaxUvSets : 0;
        for (const TextureInput& in : constants.material.inputs)
            if (in.texture && in.uv_set >= uv_sets) uv_sets = in.uv_set + 1;
        const ShadingFamily family = family_of(constants.material.model);
        const SurfaceLayout& l = constants.job.layout;
        find = &find_surfaces<AnyLayout>;
        shade = family == kUnlit      ? &shade_surfaces<AnyLayout, kUnlit, kMaxUvSets>
                : family == kTextbook ? &shade_surfaces<AnyLayout, kTextbook, kMaxUvSets>
                                      : &shade_surfaces<AnyLayout, kMicrofacet, kMaxUvSets>;
        if (l == NormalOnly::kLayout) {
            find = &find_surfaces<NormalOnly>;
            if (uv_sets == 0)
                shade = family == kTextbook ? &shade_surfaces<NormalOnly, kTextbook, 0>
                                            : &shade_surfaces<NormalOnly, kMicrofacet, 0>;
        } else if (l == NormalAndUv::kLayout) {
            find = &find_surfaces<NormalAndUv>;
            if (uv_sets == 1)
                shade = family == kTextbook ? &shade_surfaces<NormalAndUv, kTextbook, 1>
                                            : &shade_surfaces<NormalAndUv, kMicrofacet, 1>;
        } else if (l == ColorOnly::kLayout) {
            find = &find_surfaces<ColorOnly>;
            if (uv_sets == 0) shade = &shade_surfaces<ColorOnly, kUnlit, 0>;
        }
    }
};

// Fills part `part` of the points with a block of the tile. Returns whether anything of it is seen.
TESSERA_INLINE bool take_block(const ShadeJob& job, int block, int part, Points& points) {
    // Whole numbers below 2^24, so their sums are exact.
    const Float columns = to_float(lane_column() << 8), rows = to_float(lane_row() << 8);
    const int blocks = job.side / kBlockSide;
    const float x = static_cast<float>(256 * (job.x0 + block % blocks * kBlockSide) + job.offset.x),
                y = static_cast<float>(256 * (job.y0 + block / blocks * kBlockSide) + job.offset.y);
    std::uint64_t seen = 0;
    for (int i = 0; i < kBlockVectors; ++i) {
        const int at = i * kLanes<Float>, k = part * kBlockVectors + i;
        points.used[k] = mask_bits(points.ordinals(k) != Uint(0u));
        points.x[k] = columns + Float(x + static_cast<float>(256 * (at % kBlockSide)));
        points.y[k] = rows + Float(y + static_cast<float>(256 * (at / kBlockSide)));
        seen |= static_cast<std::uint64_t>(points.used[k]) << at;
    }
    job.hit[block] |= seen;
    return seen != 0;
}

// One sample a pixel: the display values of a vector of the points.
TESSERA_INLINE Uint developed(const FilmView& film, const Points& points, int k, Uint background) {
    const Float zero(0.0f), one(1.0f);
    if (points.used[k] == kAllLanes) return display_pixels(film, points.shaded[k].radiance, one);
    if (!points.used[k]) return background;
    const Mask covered = points.ordinals(k) != Uint(0u);
    const Vec3T<Float>& c = points.shaded[k].radiance;
    return display_pixels(film, {select(covered, c.x, zero), select(covered, c.y, zero), select(covered, c.z, zero)},
                          select(covered, one, zero));
}

// From the radiance of the points to blocks of the picture.
__attribute__((noinline)) inline void develop_blocks(const DevelopJob& job, const Points& points, int block,
                                                     Uint background) {
    const FilmView film = job.film;
    const TileWindow window = job.window;
    const int blocks = window.side / kBlockSide, row = block / blocks * kBlockSide;
    for (int part = 0; part < kPointBlocks; part += 2)
        write_pair(job.rgba, window, (block + part) % blocks * kBlockSide, row, [&](int i) TESSERA_INLINE_LAMBDA {
            return developed(film, points, part * kBlockVectors + i, background);
        });
}

// Several: adds a block to the sums, or begins them.
__attribute__((noinline)) inline void add_block(const ShadeJob& job, const Points& points, int part, int block) {
    const Float zero(0.0f), one(1.0f);
    for (int i = 0; i < kBlockVectors; ++i) {
        const int at = block * kBlockPixels + i * kLanes<Float>, k = part * kBlockVectors + i;
        if (!points.used[k]) {
            if (!job.first) continue;
            store(job.r + at, zero), store(job.g + at, zero);
            store(job.b + at, zero), store(job.alpha + at, zero);
            continue;
        }
        const Mask covered = points.ordinals(k) != Uint(0u);
        const auto add = [&](float* plane, Float value) {
            const Float before = job.first ? zero : load<Float>(plane + at);
            store(plane + at, before + select(covered, value, zero));
        };
        add(job.r, points.shaded[k].radiance.x);
        add(job.g, points.shaded[k].radiance.y);
        add(job.b, points.shaded[k].radiance.z);
        add(job.alpha, one);
    }
}

inline void shade_blocks(const ShadeJob& job) {
    const ShadeConstants constants(job);
    const Stages stages(constants);
    const Float zero(0.0f);
    const Uint background = job.develop ? display_pixels(job.develop->film, {zero, zero, zero}, zero) : Uint(0u);
    const int blocks = job.side / kBlockSide * (job.side / kBlockSide);
    static_assert(32 / kBlockSide % kPointBlocks == 0, "the smallest tile's rows are whole numbers of them");
    Points points;
    for (int block = 0; block < blocks; block += kPointBlocks) {
        points.numbers = job.ordinal + block * kBlockPixels;
        bool some = false;
        for (int part = 0; part < kPointBlocks; ++part) some |= take_block(job, block + part, part, points);
        if (some) {
            stages.find(constants, points);
            stages.shade(constants, points);
        }
        if (job.develop)
            develop_blocks(*job.develop, points, block, background);
        else
            for (int part = 0; part < kPointBlocks; ++part) add_block(job, points, part, block + part);
    }
    if (job.develop && job.develop->window.streamed) flush_streams();
}

inline void shade_list(const ShadeJob& job) {
    const ShadeConstants constants(job);
    const Stages stages(constants);
    constexpr std::uint32_t kWidth = kLanes<Float>;
    Points points;
    for (std::uint32_t first = 0; first < job.count; first += kPointBlocks * kBlockPixels) {
        points.numbers = job.list + first;
        for (std::uint32_t i = 0; i < kVectors; ++i) {
            const std::uint32_t at = first + i * kWidth;
            points.used[i] = 0;
            if (at >= job.count) continue;
            const std::uint32_t left = job.count - at;
            points.used[i] = left < kWidth ? (1u << left) - 1 : kAllLanes;
            points.x[i] = to_float(load<Int>(job.x + at));
            points.y[i] = to_float(load<Int>(job.y + at));
        }
        stages.find(constants, points);
        stages.shade(constants, points);
        for (std::uint32_t i = 0; i < kVectors; ++i) {
            const std::uint32_t at = first + i * kWidth;
            if (at >= job.count) break;
            store(job.r + at, points.shaded[i].radiance.x);
            store(job.g + at, points.shaded[i].radiance.y);
            store(job.b + at, points.shaded[i].radiance.z);
            store(job.alpha + at, points.shaded[i].alpha);
        }
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
