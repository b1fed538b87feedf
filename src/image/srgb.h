// The sRGB transfer function (IEC 61966-2-1) for kernels: templates over the number type, exact. The
// tables are plain constant data, defined in color.cpp, computed at compile time without libm.
#pragma once

#include "simd/vec.h"

#include <cstdint>

namespace tessera {

// Encoding works on the bits of the number. All floats of [2^-13, 1) that share their exponent and the
// first 7 bits of the mantissa form a bucket; below 2^-13 the code is 0. A bucket is so narrow that at
// most one of the 255 thresholds between codes lies in it. Its entry is
//   (code at its start << 16) + (0x10000 - low 16 bits of the threshold, or 0 when it has none),
// so that adding the low 16 bits of a number carries into the code exactly from the threshold on.
inline constexpr std::int32_t kSrgb8FirstBucket = 0x3900;  // bits of 2^-13, shifted
inline constexpr std::int32_t kSrgb8Buckets = 0x3f80 - kSrgb8FirstBucket;

struct SrgbTables {
    float linear[256];                   // of each 8-bit code, correctly rounded; 0 and 1 at the ends
    std::int32_t bucket[kSrgb8Buckets];  // see above
};
extern const SrgbTables kSrgbTables;

// The 8-bit code (0 .. 255) nearest to the sRGB encoding of linear x: exact for every float. What is
// below 0 or NaN becomes 0, what is above 1 becomes 255.
template <class F>
TESSERA_INLINE IntOf<F> srgb8_from_linear(F x) {
    using Int = IntOf<F>;
    const Int bits = as_int(clamp(x, F(0x1p-13f), F(0x1.fffffep-1f)));
    const Int entry = gather(&kSrgbTables.bucket[0], shift_right_logical(bits, 16) - Int(kSrgb8FirstBucket));
    return shift_right_logical(entry + (bits & Int(0xffff)), 16);
}

// Luminance of a linear Rec. 709 colour (ITU-R BT.709-6, item 3.2).
template <class F>
TESSERA_INLINE F luminance(F r, F g, F b) {
    return F(0.2126f) * r + F(0.7152f) * g + F(0.0722f) * b;
}

}  // namespace tessera
