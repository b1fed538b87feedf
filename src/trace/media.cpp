// Surfaces that let light through: which media lie on their two sides, and which rays their points send on.
#include "tile/tile.h"
#include "trace/waves.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr int kMostPasses = 64;  // of straight rays

}  // namespace

// Sets the indices of refraction, and finds the points that are no boundary at all.
void WaveShader::cross(const TileTask& task, Wave& wave) {
    const MaterialView* const materials = scene_->shading->materials;
    std::fill_n(clear_.reserve(wave.point_count + kMaxLanes), wave.point_count, 0u);
    for (const PointBatch& b : wave.batches) {
        const std::uint32_t m = task.frame.instances[b.instance].material;
        if (!may_transmit(materials[m])) continue;
        for (std::uint32_t p = b.first; p < b.first + b.count; ++p) {
            const RayState& state = wave.states[wave.ray[p]];
            const Boundary here = boundary(state.media, m, wave.points[kFacing][p] > 0.0f, state.channel, materials);
            clear_[p] = here.clear ? ~0u : 0u;
            for (int c = 0; c < 3; ++c) wave.points[kEtaR + c][p] = here.eta[c];
        }
    }
}

// Which rays every point may send, after it was shaded.
void WaveShader::choose_rays(const TileTask& task, Wave& wave, bool camera) {
    const MaterialView* const materials = scene_->shading->materials;
    for (Buffer<std::uint32_t>* b : {&bounding_, &stopped_, &whole_, &dispersed_, &blended_})
        std::fill_n(b->reserve(wave.point_count + kMaxLanes), wave.point_count, 0u);
    has_dispersed_ = has_blended_ = false;
    const auto scale = [&](std::uint32_t p, float factor) {
        for (const int n : {kRadianceR, kRadianceG, kRadianceB, kReflectedR, kReflectedG, kReflectedB, kEnteringR,
                            kEnteringG, kEnteringB})
            wave.shades[n][p] *= factor;
    };
    for (const PointBatch& b : wave.batches) {
        const MaterialView& material = materials[task.frame.instances[b.instance].material];
        const bool transmits = may_transmit(material), blends = material.alpha_mode == AlphaMode::kBlend && !camera;
        const bool disperses = material.ior[0] != material.ior[2] && !material.thin;
        for (std::uint32_t p = b.first; p < b.first + b.count; ++p) {
            const RayState& state = wave.states[wave.ray[p]];
            const bool clear = transmits && clear_[p];
            if (clear) {
                scale(p, 0.0f);
                for (int c = 0; c < 3; ++c) wave.shades[kEnteringR + c][p] = 1.0f;
                wave.shades[kAlpha][p] = 1.0f;
            } else if (blends) {
                scale(p, wave.shades[kAlpha][p]);
            }
            if (clear || (transmits && material.thin))
                for (int c = 0; c < 3; ++c) wave.points[kEtaR + c][p] = 1.0f;
            const bool may_pass = state.passes < kMostPasses, may_turn = state.depth < scene_->max_depth;
            const bool splits = disperses && state.channel == 0 && !clear;
            if (!clear) (may_turn ? bounding_ : stopped_)[p] = ~0u;
            if (transmits && (clear ? may_pass : may_turn)) (splits ? dispersed_ : whole_)[p] = ~0u;
            if (blends && may_pass) blended_[p] = ~0u;
            has_dispersed_ |= splits;
            has_blended_ |= blends;
        }
    }
}

// What the medium leaves of the light that came along the rays of a wave.
void WaveShader::absorb(Wave& wave) const {
    const MaterialView* const materials = scene_->shading->materials;
    for (std::uint32_t p = 0; p < wave.point_count; ++p) {
        const std::uint32_t ray = wave.ray[p];
        if (!wave.used[p] || wave.states[ray].media.count == 0) continue;
        const MaterialView& medium = materials[wave.states[ray].media.current(materials)];
        if (std::all_of(medium.absorption, medium.absorption + 3, [](float a) { return a == 0.0f; })) continue;
        const Vec3T<float> left = transmittance(Vec3T<float>::load(medium.absorption), wave.distance[p]);
        const float part[3] = {left.x, left.y, left.z};
        for (std::size_t c = 0; c < 3; ++c) wave.kept[c][ray] = part[c];
        wave.points[kTimes][p] *= std::max({left.x, left.y, left.z});
    }
}

RayState WaveShader::next_state(const TileTask& task, const Wave& from, std::uint32_t point,
                                const SpawnJob& job) const {
    RayState state = from.states[from.ray[point]];
    const std::uint32_t m = task.frame.instances[from.instance[from.ray[point]]].material;
    const MaterialView& material = scene_->shading->materials[m];
    const bool body = may_transmit(material) && !material.thin, entering = from.points[kFacing][point] > 0.0f;
    if (job.kind == SpawnJob::Kind::kStraight) {
        ++state.passes;
        if (body) state.media = state.media.beyond(m, entering);
        return state;
    }
    if (job.kind == SpawnJob::Kind::kMirrored) {
        ++state.depth;
        state.straight = false;
        return state;
    }
    if (body) state.media = state.media.beyond(m, entering);
    ++(clear_[point] ? state.passes : state.depth);
    if (job.channels[0] != job.channels[1] || job.channels[1] != job.channels[2])
        state.channel = static_cast<std::uint8_t>(job.channels[0] > 0 ? 1 : job.channels[1] > 0 ? 2 : 3);
    return state;
}

}  // namespace tessera
