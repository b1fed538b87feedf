// What texture lookups ask of lanes beyond arithmetic: tables by mip level, the weighted mean of four
// neighbouring texels, the mean of two levels. Texels are 15-bit fixed point and stay packed, 16 bits a
// channel, until channels() makes floats of them; texels are fetched by 128-bit loads, two neighbours at
// a time. The one-lane versions define the meaning.
#pragma once

#include "simd/records.h"

namespace tessera {

// Red, green, blue, alpha: 0 .. 32767 is 0 .. 1.
struct Texel {
    std::int16_t c[4];
    friend bool operator==(const Texel&, const Texel&) = default;
};
inline constexpr int kTexelOne = 32767;

// Weights are 0 .. 32767 of 1/32768: the second number is approached, never reached by its weight alone.
inline constexpr int kWeightBits = 15;

// a + (b - a) w, the product rounded to nearest, halves upwards: never outside of a .. b, and a for w = 0.
TESSERA_INLINE std::int16_t mix15(std::int16_t a, std::int16_t b, std::int32_t w) {
    return static_cast<std::int16_t>(a + (((b - a) * w + (1 << (kWeightBits - 1))) >> kWeightBits));
}
TESSERA_INLINE Texel mix_texels(Texel a, Texel b, std::int32_t w) {
    return {{mix15(a.c[0], b.c[0], w), mix15(a.c[1], b.c[1], w), mix15(a.c[2], b.c[2], w), mix15(a.c[3], b.c[3], w)}};
}
// Between texels[i], its right neighbour and the two that lie `stride` behind them: first down, then
// across. All four are read, whatever their weight.
TESSERA_INLINE Texel load_bilinear(const Texel* texels, std::int32_t i, std::int32_t stride, std::int32_t across,
                                   std::int32_t down) {
    const Texel* top = texels + i;
    const Texel* bottom = top + stride;
    return mix_texels(mix_texels(top[0], bottom[0], down), mix_texels(top[1], bottom[1], down), across);
}
// 0 .. 1, exact at both ends.
TESSERA_INLINE void channels(Texel t, float& r, float& g, float& b, float& a) {
    constexpr float kScale = 1.0f / kTexelOne;
    r = static_cast<float>(t.c[0]) * kScale;
    g = static_cast<float>(t.c[1]) * kScale;
    b = static_cast<float>(t.c[2]) * kScale;
    a = static_cast<float>(t.c[3]) * kScale;
}

// table[i] of a table of 16 numbers, all of which may be read.
template <PlainNumber T>
TESSERA_INLINE T lookup16(const T* table, std::int32_t i) {
    return table[i];
}

}  // namespace tessera

#if defined(TESSERA_ISA_NAMESPACE) && TESSERA_SIMD_LANES > 1

namespace tessera::TESSERA_ISA_NAMESPACE::lanes {

using Tag16 = hn::Repartition<std::int16_t, Tag<float>>;
using Raw16 = hn::Vec<Tag16>;

// A texel per lane. Lanes go by fours, one four to 128 bits as everywhere in records.h.
struct Texels {
    Raw16 low, high;  // of each four lanes the first two, and the other two
};

TESSERA_INLINE Raw16 mix15(Raw16 a, Raw16 b, Raw16 w) { return hn::Add(a, hn::MulFixedPoint15(hn::Sub(b, a), w)); }

// The weight of each lane, for the channels of its texel.
struct TexelWeights {
    Raw16 low, high;  // where Texels has the lanes

    TESSERA_INLINE explicit TexelWeights(Int w) {
        const Int twice = w | (w << 16);
        const Tag16 d;
        const Tag<std::int32_t> d32;
        low = hn::BitCast(d, hn::InterleaveLower(d32, twice.v, twice.v));
        high = hn::BitCast(d, hn::InterleaveUpper(d32, twice.v, twice.v));
    }
};
TESSERA_INLINE Texels mix_texels(Texels a, Texels b, TexelWeights w) {
    return {mix15(a.low, b.low, w.low), mix15(a.high, b.high, w.high)};
}
TESSERA_INLINE Texels mix_texels(Texels a, Texels b, Int w) { return mix_texels(a, b, TexelWeights(w)); }

// To be read lane by lane: the compiler must not see that it could take the lanes out of the register
// instead, two or three instructions for each of them.
TESSERA_INLINE void spill(std::int32_t (&to)[kCount], Int v) {
    store_aligned(to, v);
    __asm__("" : "+m"(to));
}

// Of the `n`th lane of every four: its texel and the right neighbour.
TESSERA_INLINE Raw16 load_pairs(const Texel* texels, const std::int32_t (&at)[kCount], int n) {
    const auto pointer = [&](int q) { return reinterpret_cast<const float*>(texels + at[4 * q + n]); };
    return hn::BitCast(Tag16(), load_quarters(pointer).v);
}
// The same of both rows, mixed downwards.
TESSERA_INLINE auto load_column(const Texel* texels, const std::int32_t (&top)[kCount],
                                const std::int32_t (&bottom)[kCount], int n, Raw<std::int32_t> down) {
    const Raw16 above = load_pairs(texels, top, n), below = load_pairs(texels, bottom, n);
    return hn::BitCast(hn::Repartition<std::uint64_t, Tag<float>>(), mix15(above, below, hn::BitCast(Tag16(), down)));
}

TESSERA_INLINE Texels load_bilinear(const Texel* texels, Int i, Int stride, Int across, Int down) {
    const Tag16 d;
    const hn::Repartition<std::uint64_t, Tag<float>> pair;
    alignas(64) std::int32_t top[kCount], bottom[kCount];
    spill(top, i);
    spill(bottom, i + stride);
    const Int down_twice = down | (down << 16);
    const auto c0 = load_column(texels, top, bottom, 0, hn::Broadcast<0>(down_twice.v));
    const auto c1 = load_column(texels, top, bottom, 1, hn::Broadcast<1>(down_twice.v));
    const auto c2 = load_column(texels, top, bottom, 2, hn::Broadcast<2>(down_twice.v));
    const auto c3 = load_column(texels, top, bottom, 3, hn::Broadcast<3>(down_twice.v));
    const Texels left{hn::BitCast(d, hn::InterleaveLower(pair, c0, c1)),
                      hn::BitCast(d, hn::InterleaveLower(pair, c2, c3))};
    const Texels right{hn::BitCast(d, hn::InterleaveUpper(pair, c0, c1)),
                       hn::BitCast(d, hn::InterleaveUpper(pair, c2, c3))};
    return mix_texels(left, right, TexelWeights(across));
}

TESSERA_INLINE void channels(Texels t, Float& r, Float& g, Float& b, Float& a) {
    const Tag16 d;
    const Raw16 zero = hn::Zero(d);
    const Raw16 even = hn::InterleaveLower(d, t.low, t.high), odd = hn::InterleaveUpper(d, t.low, t.high);
    const Raw16 rg = hn::InterleaveLower(d, even, odd), ba = hn::InterleaveUpper(d, even, odd);
    const auto widened = [](Raw16 v) { return Int(hn::BitCast(Tag<std::int32_t>(), v)); };
    const Float scale(1.0f / kTexelOne);
    r = to_float(widened(hn::InterleaveLower(d, rg, zero))) * scale;
    g = to_float(widened(hn::InterleaveUpper(d, rg, zero))) * scale;
    b = to_float(widened(hn::InterleaveLower(d, ba, zero))) * scale;
    a = to_float(widened(hn::InterleaveUpper(d, ba, zero))) * scale;
}

// In registers where there are as many as 16 or half of it; elsewhere one by one.
template <class L>
TESSERA_INLINE Vector<L> lookup16(const L* table, Int i) {
    if constexpr (kCount < 8) {
        return gather(table, i);
    } else {
        const Tag<L> d;
        const auto at = hn::IndicesFromVec(d, i.v);
        const Vector<L> first(hn::TableLookupLanes(hn::LoadU(d, table), at));
        if constexpr (kCount == 16) {
            return first;
        } else {
            return select(i < Int(8), first, Vector<L>(hn::TableLookupLanes(hn::LoadU(d, table + 8), at)));
        }
    }
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE::lanes

#endif
