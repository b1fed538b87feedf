#include "cli/statistics.h"

#include "cli/json_writer.h"
#include "cli/planes.h"

#include <tessera/version.h>

#include <sys/resource.h>

#include <cstdio>

namespace tessera::cli {

double peak_memory_mb() {
    struct rusage usage {};
    if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
    return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts KiB
}

namespace {

std::string hash_text(std::uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

// Of the planes beside the colour that there are.
void add_plane_hashes(JsonWriter& json, const RenderResult& result) {
    json.key("plane_hashes").begin_object();
    for (const Aov aov : {Aov::kAlpha, Aov::kDepth, Aov::kNormal, Aov::kShadingNormal, Aov::kUv, Aov::kPosition,
                          Aov::kAlbedo, Aov::kNode, Aov::kMaterial, Aov::kPrimitive, Aov::kMotion, Aov::kMotionSeen})
        if (const Image& plane = plane_of(aov, result); !plane.empty())
            json.member(name(aov), std::string_view(hash_text(hash_pixels(plane))));
    if (!result.linear.empty()) json.member("linear", std::string_view(hash_text(hash_pixels(result.linear))));
    json.end_object();
}

}  // namespace

std::string statistics_json(const std::string& scene, const RenderOptions& options, const RenderResult& result,
                            const CommandTimes& times) {
    const RenderStats& stats = result.stats;

    JsonWriter json;
    json.begin_object();
    json.member("version", TESSERA_VERSION).member("scene", scene);
    json.member("engine", name(stats.engine)).member("isa", name(stats.isa)).member("threads", stats.threads);
    json.member("width", options.width).member("height", options.height);
    json.member("samples", options.samples).member("exposure", stats.exposure);
    if (!result.color.empty()) json.member("color_hash", std::string_view(hash_text(stats.color_hash)));
    add_plane_hashes(json, result);
    json.member("triangles", stats.triangles);
    json.key("culls").begin_object();
    json.member("frustum", stats.culled_frustum).member("backface", stats.culled_backface);
    json.member("degenerate", stats.culled_degenerate).member("no_sample", stats.culled_no_sample);
    json.end_object();
    json.member("clipped", stats.clipped);
    json.member("small_triangles", stats.small_triangles).member("large_triangles", stats.large_triangles);
    json.member("samples_tested", stats.samples_tested).member("fragments_passed", stats.fragments_passed);
    json.member("blocks_drawn", stats.blocks_drawn).member("blocks_hidden", stats.blocks_hidden);
    json.member("pixels_covered", stats.pixels_covered).member("tile_side", stats.tile_side);
    json.key("rays").begin_object();
    json.member("primary", stats.primary_rays).member("shadow", stats.shadow_rays);
    json.member("mirrored", stats.mirrored_rays).member("refracted", stats.refracted_rays);
    json.member("straight", stats.straight_rays).member("ended_by_depth", stats.ended_by_depth);
    json.member("ended_by_contribution", stats.ended_by_contribution).end_object();
    json.key("hierarchies").begin_object();
    json.member("all", stats.hierarchies).member("built", stats.hierarchies_built);
    json.member("refitted", stats.hierarchies_refitted).member("bytes", stats.hierarchy_bytes).end_object();
    json.key("phases_ms").begin_object();
    for (const auto& [phase, milliseconds] : stats.phases_ms) json.member(phase, milliseconds);
    json.end_object();
    json.member("frame_ms", stats.frame_ms).member("cpu_ms", stats.cpu_ms);
    json.member("load_ms", times.load_ms).member("encode_ms", times.encode_ms).member("total_ms", times.total_ms);
    json.member("peak_rss_mb", peak_memory_mb());
    json.key("warnings").begin_array();
    for (const std::string& warning : result.warnings) json.value(std::string_view(warning));
    json.end_array();
    return json.end_object().text();
}

}  // namespace tessera::cli
