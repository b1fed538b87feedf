// Counts and measures of a scene for `tessera info`, and their two forms.
#pragma once

#include <tessera/scene.h>

#include <cstdint>
#include <string>

namespace tessera::cli {

struct SceneSummary {
    std::uint64_t primitives = 0, vertices = 0, triangles = 0;  // as stored
    std::uint64_t shapes = 0;                                   // primitives that are spheres, discs and planes
    std::uint64_t drawn_instances = 0, drawn_triangles = 0;     // as the active scene draws them
    std::uint64_t drawn_points = 0, drawn_lines = 0;
    std::uint64_t memory_bytes = 0;
    Bounds3 bounds;  // of what is drawn, world space
};

// `scene` must be valid (what load_scene() returns is).
SceneSummary summarize(const Scene& scene);
std::string summary_text(const std::string& file, const Scene& scene, const SceneSummary& summary);
std::string summary_json(const std::string& file, const Scene& scene, const SceneSummary& summary);

}  // namespace tessera::cli
