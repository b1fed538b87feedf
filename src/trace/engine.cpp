#include "trace/engine.h"

#include "tile/tile.h"
#include "trace/trace_visibility.h"
#include "trace/waves.h"

#include <algorithm>
#include <mutex>
#include <optional>

namespace tessera {
namespace {

TraceClass class_of(const InstanceView& instance, const MaterialView& material) {
    TraceClass c;
    const bool transmits = may_transmit(material);
    c.undecided = material.alpha_mode != AlphaMode::kOpaque;
    c.mask = instance.mesh.is_stroke() ? kMeetsStroke : c.undecided || transmits ? kMeetsSheer : kMeetsSolid;
    c.culled = !material.double_sided;
    c.seen_inside = transmits && !material.thin;
    return c;
}

// What a surface lets through of light that goes straight on, if that depends on no texture and no vertex.
std::optional<Vec3T<float>> even_transmittance(const InstanceView& instance, const MaterialView& material) {
    bool even = instance.mesh.colors == nullptr;
    for (const TextureInput& in : material.inputs) even = even && !in.texture;
    if (!even) return std::nullopt;
    SurfacePoint<float> anywhere{};
    anywhere.normal = anywhere.view = anywhere.geometric_normal = {0, 0, 1};
    anywhere.color = {1, 1, 1, 1};
    return straight_through(material, anywhere);
}

int choose_tile_side(const PictureSettings& settings, const ProjectionView& picture) {
    if (settings.tile_side != 0) return settings.tile_side;
    return picture.width * picture.height > 640 * 480 ? 64 : 32;
}

}  // namespace

struct LightTracer::State {
    State(Isa i, std::uint64_t max_bytes) : isa(i), scene(i, max_bytes) {}

    Isa isa;
    EmbreeScene scene;
    TransportScene transport{};
    TilePool<TraceVisibility> tiles;
    std::mutex mutex;
    std::vector<std::unique_ptr<WaveShader>> idle;
};

LightTracer::LightTracer(Isa isa, std::uint64_t max_bytes) : state_(std::make_unique<State>(isa, max_bytes)) {}
LightTracer::~LightTracer() = default;

void LightTracer::begin(const Frame& frame, const ShadingContext& shading, const TransportSettings& settings,
                        Arena& arena) {
    std::vector<TraceClass> classes;
    TransportScene& t = state_->transport;
    t.instance_size.clear();
    t.even_transmittance.clear();
    t.simple = true;
    for (std::size_t i = 0; i < frame.instances.size(); ++i) {
        const InstanceView& instance = frame.instances[i];
        classes.push_back(class_of(instance, shading.materials[instance.material]));
        t.simple = t.simple && classes.back().mask == kMeetsSolid;
        t.even_transmittance.push_back(even_transmittance(instance, shading.materials[instance.material]));
        t.instance_size.push_back(largest_coordinate(instance, *frame.prepared[i]));
    }
    state_->scene.update(frame, classes, arena);
    t.scene = &state_->scene;
    t.frame = &frame;
    t.shading = &shading;
    t.kernels = &trace_kernels(state_->isa);
    t.shadows = settings.shadows;
    t.bounces = settings.bounces;
    t.max_depth = settings.max_depth;
    t.least = settings.least;
    t.spread = picture_spread(frame.projection);
    std::copy_n(settings.background, 3, t.background);
    for (const std::unique_ptr<WaveShader>& shader : state_->idle) shader->begin(t);
}

const BuildStatistics& LightTracer::build() const { return state_->scene.statistics(); }

TransportCounters LightTracer::counters() const {
    TransportCounters sum;
    for (const std::unique_ptr<WaveShader>& shader : state_->idle) {
        const TransportCounters& c = shader->counters;
        sum.shadow_rays += c.shadow_rays;
        sum.mirrored_rays += c.mirrored_rays;
        sum.refracted_rays += c.refracted_rays;
        sum.straight_rays += c.straight_rays;
        sum.ended_by_depth += c.ended_by_depth;
        sum.ended_by_contribution += c.ended_by_contribution;
    }
    return sum;
}

TraceCounters LightTracer::draw(const Frame& frame, const ShadingContext& shading, const PictureSettings& settings,
                                const PictureTargets& targets, Arena& arena) {
    const TileGrid grid(static_cast<int>(frame.projection.width), static_cast<int>(frame.projection.height),
                        choose_tile_side(settings, frame.projection));
    const TileTask task(frame, shading, settings, targets, grid, nullptr);
    const TraceSource source{&state_->scene,        &frame, &shading, &trace_kernels(state_->isa), targets.labels.any(),
                             settings.max_fragments};
    state_->tiles.draw(task, arena, [&](TraceVisibility& visibility) { visibility.begin(source); });
    TraceCounters counters;
    counters.tile_side = grid.side;
    state_->tiles.visit([&](const auto& worker) {
        counters.primary_rays += worker.visibility.rays;
        counters.hits += worker.visibility.hits;
        counters.pixels_covered += worker.tile.pixels_covered;
    });
    return counters;
}

std::unique_ptr<PointShader> LightTracer::take() {
    {
        const std::lock_guard lock(state_->mutex);
        if (!state_->idle.empty()) {
            std::unique_ptr<WaveShader> shader = std::move(state_->idle.back());
            state_->idle.pop_back();
            return shader;
        }
    }
    auto shader = std::make_unique<WaveShader>();
    shader->begin(state_->transport);
    return shader;
}

void LightTracer::give(std::unique_ptr<PointShader> shader) {
    const std::lock_guard lock(state_->mutex);
    state_->idle.emplace_back(static_cast<WaveShader*>(shader.release()));
}

}  // namespace tessera
