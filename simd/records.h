// Between records in memory and lanes: lane i of the vectors is the record at pointer(i). 128-bit loads
// and a transposition in registers, which is several times faster than gathering each number. The
// one-lane versions define the meaning; `pointer` is called once for every lane.
#pragma once

#include "simd/vec.h"

namespace tessera {

// Four floats of every record.
template <class Pointer>
TESSERA_INLINE void load_records(Pointer&& pointer, float& a, float& b, float& c, float& d) {
    const float* p = pointer(0);
    a = p[0], b = p[1], c = p[2], d = p[3];
}
template <class Pointer>
TESSERA_INLINE void store_records(Pointer&& pointer, float a, float b, float c, float d) {
    const float numbers[4] = {a, b, c, d};
    __builtin_memcpy(pointer(0), numbers, sizeof numbers);  // records may be of any type
}
// kLanes consecutive records of three floats.
TESSERA_INLINE void load_triples(const float* p, float& a, float& b, float& c) { a = p[0], b = p[1], c = p[2]; }

// An array of records of kNumbers floats that may be read four floats at a time: the last record, after
// which memory may end, is read from a copy.
template <int kNumbers>
struct RecordArray {
    const float* base = nullptr;
    std::uint32_t last = 0;
    float tail[4] = {0, 0, 0, 0};

    TESSERA_INLINE RecordArray() = default;
    TESSERA_INLINE RecordArray(const float* array, std::uint32_t count) : base(array), last(count - 1) {
        if (array)
            for (int i = 0; i < kNumbers; ++i) tail[i] = array[std::size_t{last} * kNumbers + i];
    }
    TESSERA_INLINE const float* at(std::uint32_t i) const {
        return i == last ? tail : base + std::size_t{i} * kNumbers;
    }
};

// Eight numbers at a time to pointer(0), pointer(1), ..., or all of them where the vector has fewer.
template <class Pointer>
TESSERA_INLINE void store_eights(Pointer&& pointer, std::uint32_t a) {
    __builtin_memcpy(pointer(0), &a, sizeof a);
}

// Streams go past the caches, to memory on a boundary of the vector; flush_streams() before another thread reads it.
TESSERA_INLINE void stream(std::uint32_t* p, std::uint32_t a) { *p = a; }
// Eight numbers of a and eight of b beside them at a time, as store_eights() has them, to pointer(0), pointer(1), ...
template <class Pointer>
TESSERA_INLINE void stream_eights(Pointer&& pointer, std::uint32_t a, std::uint32_t b) {
    std::uint32_t* const to = pointer(0);
    to[0] = a, to[8] = b;
}
TESSERA_INLINE void flush_streams() {
#ifdef __SSE2__
    __builtin_ia32_sfence();
#endif
}

TESSERA_INLINE std::uint32_t or3(std::uint32_t a, std::uint32_t b, std::uint32_t c) { return a | b | c; }
TESSERA_INLINE std::int32_t or3(std::int32_t a, std::int32_t b, std::int32_t c) { return a | b | c; }
// The inverse of mask_bits().
template <class M>
TESSERA_INLINE M mask_of_bits(std::uint32_t bits) {
    if constexpr (std::is_same_v<M, bool>) {
        return bits & 1;
    } else {
        return M::of_bits(bits);
    }
}
// The lanes of the mask first, in their order; what follows them is not specified.
TESSERA_INLINE float compress(float a, bool) { return a; }
// The least of the lanes; which zero it is where both signs occur is not specified.
TESSERA_INLINE float least_lane(float a) { return a; }

}  // namespace tessera

#if defined(TESSERA_ISA_NAMESPACE) && TESSERA_SIMD_LANES > 1

namespace tessera::TESSERA_ISA_NAMESPACE::lanes {

// Within each 128 bits: (a, b, c, d) are the rows of a 4x4 matrix, and become its columns.
TESSERA_INLINE void transpose4(Float& a, Float& b, Float& c, Float& d) {
    const Tag<float> f;
    const hn::Repartition<std::uint64_t, Tag<float>> u;
    const auto ab_low = hn::BitCast(u, hn::InterleaveLower(f, a.v, b.v));
    const auto ab_high = hn::BitCast(u, hn::InterleaveUpper(f, a.v, b.v));
    const auto cd_low = hn::BitCast(u, hn::InterleaveLower(f, c.v, d.v));
    const auto cd_high = hn::BitCast(u, hn::InterleaveUpper(f, c.v, d.v));
    a = Float(hn::BitCast(f, hn::InterleaveLower(u, ab_low, cd_low)));
    b = Float(hn::BitCast(f, hn::InterleaveUpper(u, ab_low, cd_low)));
    c = Float(hn::BitCast(f, hn::InterleaveLower(u, ab_high, cd_high)));
    d = Float(hn::BitCast(f, hn::InterleaveUpper(u, ab_high, cd_high)));
}

// 128 bits from each of kCount / 4 addresses.
template <class Pointer>
TESSERA_INLINE Float load_quarters(Pointer&& pointer) {
    const hn::FixedTag<float, 4> d4;
    if constexpr (kCount == 4) {
        return Float(hn::LoadU(d4, pointer(0)));
    } else {
        const hn::FixedTag < float, kCount<8 ? kCount : 8> d8;
        const auto low = hn::Combine(d8, hn::LoadU(d4, pointer(1)), hn::LoadU(d4, pointer(0)));
        if constexpr (kCount == 8) {
            return Float(low);
        } else {
            const auto high = hn::Combine(d8, hn::LoadU(d4, pointer(3)), hn::LoadU(d4, pointer(2)));
            return Float(hn::Combine(Tag<float>(), high, low));
        }
    }
}

template <class Pointer, class V>
TESSERA_INLINE void store_quarters(Pointer&& pointer, V a) {
    const hn::FixedTag<float, 4> d4;
    if constexpr (kCount == 4) {
        hn::StoreU(a.v, d4, pointer(0));
    } else if constexpr (kCount == 8) {
        hn::StoreU(hn::LowerHalf(d4, a.v), d4, pointer(0));
        hn::StoreU(hn::UpperHalf(d4, a.v), d4, pointer(1));
    } else {
        const hn::FixedTag < float, kCount<8 ? kCount : 8> d8;
        const auto low = hn::LowerHalf(d8, a.v), high = hn::UpperHalf(d8, a.v);
        hn::StoreU(hn::LowerHalf(d4, low), d4, pointer(0));
        hn::StoreU(hn::UpperHalf(d4, low), d4, pointer(1));
        hn::StoreU(hn::LowerHalf(d4, high), d4, pointer(2));
        hn::StoreU(hn::UpperHalf(d4, high), d4, pointer(3));
    }
}

template <class Pointer>
TESSERA_INLINE void load_records(Pointer&& pointer, Float& a, Float& b, Float& c, Float& d) {
    a = load_quarters([&](int q) { return pointer(4 * q); });
    b = load_quarters([&](int q) { return pointer(4 * q + 1); });
    c = load_quarters([&](int q) { return pointer(4 * q + 2); });
    d = load_quarters([&](int q) { return pointer(4 * q + 3); });
    transpose4(a, b, c, d);
}
template <class Pointer>
TESSERA_INLINE void store_records(Pointer&& pointer, Float a, Float b, Float c, Float d) {
    transpose4(a, b, c, d);
    store_quarters([&](int q) { return pointer(4 * q); }, a);
    store_quarters([&](int q) { return pointer(4 * q + 1); }, b);
    store_quarters([&](int q) { return pointer(4 * q + 2); }, c);
    store_quarters([&](int q) { return pointer(4 * q + 3); }, d);
}
TESSERA_INLINE void load_triples(const float* p, Float& a, Float& b, Float& c) {
    hn::LoadInterleaved3(Tag<float>(), p, a.v, b.v, c.v);
}

template <class Pointer, class V>
requires std::is_same_v<V, Uint> TESSERA_INLINE void store_eights(Pointer&& pointer, V a) {
    const auto to = [&](int i) { return reinterpret_cast<std::uint32_t*>(pointer(i)); };
    if constexpr (kCount == 16) {
        const hn::FixedTag < std::uint32_t, kCount<8 ? kCount : 8> d8;
        hn::StoreU(hn::LowerHalf(d8, a.v), d8, to(0));
        hn::StoreU(hn::UpperHalf(d8, a.v), d8, to(1));
    } else {
        hn::StoreU(a.v, Tag<std::uint32_t>(), to(0));
    }
}

TESSERA_INLINE void stream(std::uint32_t* p, Uint a) { hn::Stream(a.v, Tag<std::uint32_t>(), p); }
template <class Pointer>
TESSERA_INLINE void stream_eights(Pointer&& pointer, Uint a, Uint b) {
    const Tag<std::uint32_t> d;
    if constexpr (kCount == 16) {
        hn::Stream(hn::ConcatLowerLower(d, b.v, a.v), d, pointer(0));
        hn::Stream(hn::ConcatUpperUpper(d, b.v, a.v), d, pointer(1));
    } else {
        hn::Stream(a.v, d, pointer(0));
        hn::Stream(b.v, d, pointer(0) + 8);
    }
}

TESSERA_INLINE Int or3(Int a, Int b, Int c) { return Int(hn::Or3(a.v, b.v, c.v)); }
TESSERA_INLINE Uint or3(Uint a, Uint b, Uint c) { return Uint(hn::Or3(a.v, b.v, c.v)); }
TESSERA_INLINE Float compress(Float a, Mask m) { return Float(hn::Compress(a.v, m.m)); }
TESSERA_INLINE float least_lane(Float a) { return hn::GetLane(hn::MinOfLanes(Tag<float>(), a.v)); }

}  // namespace tessera::TESSERA_ISA_NAMESPACE::lanes

#endif
