// What a reference engine finds for one sample position per pixel: the nearest opaque surface, and the
// transparent ones in front of it. The rasterizer and the ray caster fill the same record; shading
// does not know which one did.
#pragma once

#include "geometry/draw_data.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace tessera {

// One transparent surface at a pixel.
struct Fragment {
    std::uint32_t pixel;
    std::uint32_t triangle;  // number in the frame, 0-based
    float depth;
};

struct VisibilityCounters {
    std::uint64_t triangles = 0, culled_frustum = 0, culled_backface = 0, culled_degenerate = 0, clipped = 0;
    std::uint64_t fragments_passed = 0;
};

struct Visibility {
    int width = 0, height = 0;
    std::vector<float> depth;             // reversed; 0 where nothing was hit
    std::vector<std::uint32_t> triangle;  // 1 + number in the frame; 0: none
    std::vector<Fragment> transparent;    // by pixel, far to near, in front of the opaque surface
    VisibilityCounters counters;
};

// What a run must obey: `checkpoint` is called now and then with the fraction done (0 .. 1) and throws
// to stop; more than `max_fragments` transparent fragments throw kLimit.
struct RunControl {
    std::function<void(double)> checkpoint;
    std::size_t max_fragments = std::size_t{1} << 28;
};

// Appends a transparent fragment; throws kLimit when there are too many.
void add_fragment(Visibility& visibility, const Fragment& fragment, const RunControl& control);

// Sorts by pixel, then far to near (at equal depth the higher number first, so that the lower one
// ends on top), and drops what lies behind the opaque surface.
void sort_transparent(Visibility& visibility);

}  // namespace tessera
