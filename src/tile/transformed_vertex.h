// A vertex in the picture as the vectors of a kernel have it: the numbers of a TransformedVertex. Part of a kernel
// file, once per instruction set.
#pragma once

#include "tile/tile_data.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// What says why a vertex is not plain.
TESSERA_INLINE Uint codes_of(const ClipVertex<Float>& clip) {
    const Float largest(kLargestCoordinate);
    const Mask usable =
        (abs(clip.x) < largest) & (abs(clip.y) < largest) & (abs(clip.z) < largest) & (abs(clip.w) < largest);
    return select(usable, out_code(clip), Uint(kUnusable));
}

// A plain vertex is usable and within the near plane and the guard band; w > 0 but for matrices beyond reason,
// whose triangles may as well take the scalar path.
TESSERA_INLINE void transform_vertex(const ClipVertex<Float>& clip, float width, float height, Float (&numbers)[4]) {
    const Float zero(0.0f), largest(kLargestCoordinate), guard = clip.w * Float(kGuardBand);
    const Float x = abs(clip.x), y = abs(clip.y);
    const Mask plain = (clip.w > zero) & (clip.w < largest) & (clip.z <= clip.w) & (abs(clip.z) < largest) &
                       (x <= guard) & (y <= guard) & (x < largest) & (y < largest);
    const PictureVertex<Float> p = to_picture(clip, width, height);
    numbers[0] = p.x, numbers[1] = p.y, numbers[2] = clip.z / clip.w, numbers[3] = Float(1.0f) / clip.w;
    if (all(plain)) return;
    numbers[0] = select(plain, numbers[0], zero);
    numbers[1] = select(plain, numbers[1], zero);
    numbers[2] = select(plain, numbers[2], as_float(codes_of(clip)));
    numbers[3] = select(plain, numbers[3], zero);
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
