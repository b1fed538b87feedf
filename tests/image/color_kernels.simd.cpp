#include "image/color_kernels.h"

#include "image/srgb.h"
#include "image/tone_map.h"

namespace tessera::TESSERA_ISA_NAMESPACE {
namespace {

constexpr int kWidth = kLanes<Float>;

void encode(const float* rgb, std::int32_t* codes, int count) {
    for (int i = 0; i < 3 * count; i += kWidth) store(codes + i, srgb8_from_linear(load<Float>(rgb + i)));
}

#define TESSERA_TONE_MAP_KERNEL(name)                                                    \
    void name(float* rgb, int count) {                                                   \
        for (int i = 0; i < count; i += kWidth) {                                        \
            Float r = load<Float>(rgb + i), g = load<Float>(rgb + count + i);            \
            Float b = load<Float>(rgb + 2 * count + i);                                  \
            tone_map_##name(r, g, b);                                                    \
            store(rgb + i, r), store(rgb + count + i, g), store(rgb + 2 * count + i, b); \
        }                                                                                \
    }                                                                                    \
    static_assert(true)
TESSERA_TONE_MAP_KERNEL(none);
TESSERA_TONE_MAP_KERNEL(neutral);
TESSERA_TONE_MAP_KERNEL(aces);

void luminances(const float* rgb, float* out, int count) {
    for (int i = 0; i < count; i += kWidth)
        store(out + i, luminance(load<Float>(rgb + i), load<Float>(rgb + count + i), load<Float>(rgb + 2 * count + i)));
}

}  // namespace

const ColorKernels& color_kernels() {
    static constexpr ColorKernels kKernels{&encode, &none, &neutral, &aces, &luminances};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
