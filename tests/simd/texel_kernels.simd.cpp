#include "simd/texel_kernels.h"

namespace tessera::TESSERA_ISA_NAMESPACE {
namespace {

constexpr int kWidth = kLanes<Float>;

template <class T>
TESSERA_INLINE void put_channels(T texel, float* planes) {
    Float r, g, b, a;
    channels(texel, r, g, b, a);
    store(planes, r);
    store(planes + kWidth, g);
    store(planes + 2 * kWidth, b);
    store(planes + 3 * kWidth, a);
}

void filter(const Texel* lower, const Texel* upper, const std::int32_t* first, const std::int32_t* stride,
            const std::int32_t* across, const std::int32_t* down, const std::int32_t* between, float* planes) {
    const Int i = load<Int>(first), s = load<Int>(stride), x = load<Int>(across), y = load<Int>(down);
    put_channels(mix_texels(load_bilinear(lower, i, s, x, y), load_bilinear(upper, i, s, x, y), load<Int>(between)),
                 planes);
}

void load_one(const Texel* texels, const std::int32_t* first, const std::int32_t* stride, const std::int32_t* across,
              const std::int32_t* down, float* planes) {
    put_channels(load_bilinear(texels, load<Int>(first), load<Int>(stride), load<Int>(across), load<Int>(down)),
                 planes);
}

void lookup_floats(const float* table, const std::int32_t* index, float* out) {
    store(out, lookup16(table, load<Int>(index)));
}
void lookup_integers(const std::int32_t* table, const std::int32_t* index, std::int32_t* out) {
    store(out, lookup16(table, load<Int>(index)));
}

}  // namespace

const TexelTable& texel_table() {
    static constexpr TexelTable kTable{kWidth, &filter, &load_one, &lookup_floats, &lookup_integers};
    return kTable;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
