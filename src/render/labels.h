// The labels of a picture: where they live, and those of the reference engines.
#pragma once

#include "raster/engine.h"
#include "reference/engine.h"

#include <tessera/render.h>

namespace tessera {

// Sets the matrix of positions and normals: from the frame's camera space to the one that the options name. Throws
// kUsage when the host's world is not rigid.
void set_label_space(const RenderOptions& options, const Frame& frame, PictureTargets& targets);

// What the pass of the labels saw, and how many pixels it labelled.
struct LabelCounts {
    VisibilityCounters counters;
    std::uint64_t pixels;
};

// Fills the planes of labels, at the pixel centre, of the nearest surface with alpha of at least one half.
LabelCounts take_labels(ReferenceEngine& engine, const Frame& frame, const RunControl& control,
                        const PictureTargets& targets);

}  // namespace tessera
