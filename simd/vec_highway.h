// The vector back end of vec.h, on Highway (static targets only: the target is that of the flags this
// file is compiled with). The only file that knows Highway. The types live in an inner namespace, so
// that their functions are found by their arguments and never hide the plain ones of namespace tessera.
#pragma once

#define HWY_COMPILE_ONLY_STATIC
#define HWY_IS_DEBUG_BUILD 0  // its assertions would print and abort
#include <hwy/highway.h>

namespace tessera::TESSERA_ISA_NAMESPACE::lanes {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kCount = TESSERA_SIMD_LANES;
static_assert(kCount == HWY_LANES(float), "the compiler flags do not enable this file's instruction set");

template <class L>
using Tag = hn::CappedTag<L, kCount>;
template <class L>
using Raw = hn::Vec<Tag<L>>;
using RawMask = hn::Mask<Tag<float>>;

alignas(64) constexpr std::int32_t kIota[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

template <class L>
struct Vector;
using Float = Vector<float>;
using Int = Vector<std::int32_t>;
using Uint = Vector<std::uint32_t>;

// One truth value per lane.
struct Mask {
    RawMask m;

    Mask() = default;
    TESSERA_INLINE explicit Mask(RawMask raw) : m(raw) {}
    template <class B>
    requires std::is_same_v<B, bool> TESSERA_INLINE Mask(B all_lanes)
        : m(hn::MaskFromVec(hn::BitCast(Tag<float>(), hn::Set(Tag<std::int32_t>(), all_lanes ? -1 : 0)))) {}

    friend TESSERA_INLINE Mask operator&(Mask a, Mask b) { return Mask(hn::And(a.m, b.m)); }
    friend TESSERA_INLINE Mask operator|(Mask a, Mask b) { return Mask(hn::Or(a.m, b.m)); }
    friend TESSERA_INLINE Mask operator^(Mask a, Mask b) { return Mask(hn::Xor(a.m, b.m)); }
    friend TESSERA_INLINE Mask operator!(Mask a) { return Mask(hn::Not(a.m)); }
    friend TESSERA_INLINE Mask operator~(Mask a) { return !a; }
    friend TESSERA_INLINE Mask& operator&=(Mask& a, Mask b) { return a = a & b; }
    friend TESSERA_INLINE Mask& operator|=(Mask& a, Mask b) { return a = a | b; }
    friend TESSERA_INLINE Mask& operator^=(Mask& a, Mask b) { return a = a ^ b; }

    friend TESSERA_INLINE bool any(Mask a) { return !hn::AllFalse(Tag<float>(), a.m); }
    friend TESSERA_INLINE bool all(Mask a) { return hn::AllTrue(Tag<float>(), a.m); }
    friend TESSERA_INLINE bool none(Mask a) { return hn::AllFalse(Tag<float>(), a.m); }
    friend TESSERA_INLINE std::uint32_t mask_bits(Mask a) {
        std::uint8_t bytes[8];
        hn::StoreMaskBits(Tag<float>(), a.m, bytes);
        if constexpr (kCount == 16) {
            std::uint16_t bits;
            __builtin_memcpy(&bits, bytes, sizeof bits);
            return bits;
        } else {
            return bytes[0] & ((1u << kCount) - 1);
        }
    }
    static TESSERA_INLINE Mask of_bits(std::uint32_t bits) {
        std::uint8_t bytes[8] = {};
        __builtin_memcpy(bytes, &bits, sizeof bits);
        return Mask(hn::LoadMaskBits(Tag<float>(), bytes));
    }
    friend TESSERA_INLINE Mask select(Mask mask, Mask a, Mask b) { return (mask & a) | ((!mask) & b); }
};

// kCount numbers of type L: what Float, Int and Uint have in common.
template <class L>
struct Vector {
    using D = Tag<L>;
    Raw<L> v;

    Vector() = default;
    TESSERA_INLINE explicit Vector(Raw<L> raw) : v(raw) {}
    // The same number in every lane.
    TESSERA_INLINE Vector(L all_lanes) : v(hn::Set(D(), all_lanes)) {}

    friend TESSERA_INLINE Vector operator+(Vector a, Vector b) { return Vector(hn::Add(a.v, b.v)); }
    friend TESSERA_INLINE Vector operator-(Vector a, Vector b) { return Vector(hn::Sub(a.v, b.v)); }
    friend TESSERA_INLINE Vector operator*(Vector a, Vector b) { return Vector(hn::Mul(a.v, b.v)); }
    friend TESSERA_INLINE Vector operator/(Vector a, Vector b) { return Vector(hn::Div(a.v, b.v)); }
    friend TESSERA_INLINE Vector operator-(Vector a) { return Vector(hn::Neg(a.v)); }
    friend TESSERA_INLINE Vector operator&(Vector a, Vector b) { return Vector(hn::And(a.v, b.v)); }
    friend TESSERA_INLINE Vector operator|(Vector a, Vector b) { return Vector(hn::Or(a.v, b.v)); }
    friend TESSERA_INLINE Vector operator^(Vector a, Vector b) { return Vector(hn::Xor(a.v, b.v)); }
    friend TESSERA_INLINE Vector operator~(Vector a) { return Vector(hn::Not(a.v)); }
    friend TESSERA_INLINE Vector operator<<(Vector a, int n) { return shift_left(a, n); }
    // Of Int arithmetic, of Uint logical, as in C++.
    friend TESSERA_INLINE Vector operator>>(Vector a, int n) { return Vector(hn::ShiftRightSame(a.v, n)); }

    friend TESSERA_INLINE Vector& operator+=(Vector& a, Vector b) { return a = a + b; }
    friend TESSERA_INLINE Vector& operator-=(Vector& a, Vector b) { return a = a - b; }
    friend TESSERA_INLINE Vector& operator*=(Vector& a, Vector b) { return a = a * b; }
    friend TESSERA_INLINE Vector& operator/=(Vector& a, Vector b) { return a = a / b; }
    friend TESSERA_INLINE Vector& operator&=(Vector& a, Vector b) { return a = a & b; }
    friend TESSERA_INLINE Vector& operator|=(Vector& a, Vector b) { return a = a | b; }
    friend TESSERA_INLINE Vector& operator^=(Vector& a, Vector b) { return a = a ^ b; }
    friend TESSERA_INLINE Vector& operator<<=(Vector& a, int n) { return a = a << n; }
    friend TESSERA_INLINE Vector& operator>>=(Vector& a, int n) { return a = a >> n; }

    friend TESSERA_INLINE Mask operator==(Vector a, Vector b) { return mask(hn::Eq(a.v, b.v)); }
    // Not Ne, which is false for NaN in AVX.
    friend TESSERA_INLINE Mask operator!=(Vector a, Vector b) { return !(a == b); }
    friend TESSERA_INLINE Mask operator<(Vector a, Vector b) { return mask(less(a, b)); }
    friend TESSERA_INLINE Mask operator>(Vector a, Vector b) { return mask(less(b, a)); }
    friend TESSERA_INLINE Mask operator<=(Vector a, Vector b) { return mask(less_equal(a, b)); }
    friend TESSERA_INLINE Mask operator>=(Vector a, Vector b) { return mask(less_equal(b, a)); }

    friend TESSERA_INLINE Vector select(Mask m, Vector a, Vector b) {
        return Vector(hn::IfThenElse(hn::RebindMask(D(), m.m), a.v, b.v));
    }
    // x86's minps and maxps are a < b ? a : b and a > b ? a : b.
    friend TESSERA_INLINE Vector min(Vector a, Vector b) { return Vector(hn::Min(a.v, b.v)); }
    friend TESSERA_INLINE Vector max(Vector a, Vector b) { return Vector(hn::Max(a.v, b.v)); }
    friend TESSERA_INLINE Vector clamp(Vector x, Vector low, Vector high) { return min(max(x, low), high); }

    friend TESSERA_INLINE Float as_float(Vector a) { return Float(hn::BitCast(Tag<float>(), a.v)); }
    friend TESSERA_INLINE Int as_int(Vector a) { return Int(hn::BitCast(Tag<std::int32_t>(), a.v)); }
    friend TESSERA_INLINE Uint as_uint(Vector a) { return Uint(hn::BitCast(Tag<std::uint32_t>(), a.v)); }

    friend TESSERA_INLINE Vector shift_left(Vector a, int n) { return Vector(hn::ShiftLeftSame(a.v, n)); }
    friend TESSERA_INLINE Vector shift_right_logical(Vector a, int n) { return from_bits(as_uint(a) >> n); }
    friend TESSERA_INLINE Vector shift_right_arithmetic(Vector a, int n) { return from_bits(as_int(a) >> n); }

    friend TESSERA_INLINE void store(L* p, Vector a) { hn::StoreU(a.v, D(), p); }
    friend TESSERA_INLINE void store_aligned(L* p, Vector a) { hn::Store(a.v, D(), p); }
    friend TESSERA_INLINE void store_n(L* p, Vector a, int n) {
        if (n >= kCount) return store(p, a);
        alignas(64) L all[kCount];
        store_aligned(all, a);
        for (int i = 0; i < n; ++i) p[i] = all[i];
    }
    // Only AVX-512's masked stores are fast.
    friend TESSERA_INLINE void store_masked(L* p, Mask m, Vector a) {
        if constexpr (kCount == 16)
            hn::BlendedStore(a.v, hn::RebindMask(D(), m.m), D(), p);
        else
            store(p, select(m, a, Vector::load(p)));
    }
    friend TESSERA_INLINE L lane(Vector a, int i) {
        alignas(64) L all[kCount];
        store_aligned(all, a);
        return all[i];
    }

    static TESSERA_INLINE Vector load(const L* p) { return Vector(hn::LoadU(D(), p)); }
    static TESSERA_INLINE Vector load_aligned(const L* p) { return Vector(hn::Load(D(), p)); }
    static TESSERA_INLINE Vector load_n(const L* p, int n) {
        if (n >= kCount) return load(p);
        alignas(64) L all[kCount] = {};
        for (int i = 0; i < n; ++i) all[i] = p[i];
        return load_aligned(all);
    }
    static TESSERA_INLINE Vector iota() {
        const Int i = Int::load_aligned(kIota);
        if constexpr (std::is_same_v<L, float>) {
            return Vector(hn::ConvertTo(D(), i.v));
        } else {
            return from_bits(i);
        }
    }

  private:
    template <class M>
    static TESSERA_INLINE Mask mask(M raw) {
        return Mask(hn::RebindMask(Tag<float>(), raw));
    }
    template <class From>
    static TESSERA_INLINE Vector from_bits(From a) {
        return Vector(hn::BitCast(D(), a.v));
    }
    static TESSERA_INLINE auto less(Vector a, Vector b) {
        if constexpr (std::is_same_v<L, std::uint32_t>) {
            return less_signed(as_int(a ^ Vector(0x80000000u)), as_int(b ^ Vector(0x80000000u)));
        } else {
            return hn::Lt(a.v, b.v);
        }
    }
    static TESSERA_INLINE auto less_signed(Int a, Int b) { return hn::Lt(a.v, b.v); }
    static TESSERA_INLINE auto less_equal(Vector a, Vector b) {
        if constexpr (std::is_same_v<L, float>) {
            return hn::Le(a.v, b.v);
        } else {
            return hn::Not(less(b, a));
        }
    }
};

// --- float only -----------------------------------------------------------------------------

TESSERA_INLINE Float abs(Float a) { return Float(hn::Abs(a.v)); }
TESSERA_INLINE Float copysign(Float a, Float b) { return Float(hn::CopySign(a.v, b.v)); }
TESSERA_INLINE Float sqrt(Float a) { return Float(hn::Sqrt(a.v)); }
TESSERA_INLINE Float round_even(Float a) { return Float(hn::Round(a.v)); }
TESSERA_INLINE Float floor(Float a) { return Float(hn::Floor(a.v)); }
TESSERA_INLINE Float ceil(Float a) { return Float(hn::Ceil(a.v)); }
TESSERA_INLINE Float trunc(Float a) { return Float(hn::Trunc(a.v)); }
// Highway's conversion saturates on both sides.
TESSERA_INLINE Int to_int(Float a) { return select(a == a, Int(hn::ConvertTo(Tag<std::int32_t>(), a.v)), Int(0)); }

// For |a| < 2^31; others give any integer.
#if defined(__AVX512F__)
TESSERA_INLINE Int nearest_int(Float a) { return Int(Raw<std::int32_t>{_mm512_cvtps_epi32(a.v.raw)}); }
TESSERA_INLINE Int truncate_int(Float a) { return Int(Raw<std::int32_t>{_mm512_cvttps_epi32(a.v.raw)}); }
#elif defined(__AVX2__)
TESSERA_INLINE Int nearest_int(Float a) { return Int(Raw<std::int32_t>{_mm256_cvtps_epi32(a.v.raw)}); }
TESSERA_INLINE Int truncate_int(Float a) { return Int(Raw<std::int32_t>{_mm256_cvttps_epi32(a.v.raw)}); }
#elif defined(__SSE2__)
TESSERA_INLINE Int nearest_int(Float a) { return Int(Raw<std::int32_t>{_mm_cvtps_epi32(a.v.raw)}); }
TESSERA_INLINE Int truncate_int(Float a) { return Int(Raw<std::int32_t>{_mm_cvttps_epi32(a.v.raw)}); }
#else
TESSERA_INLINE Int nearest_int(Float a) { return Int(hn::NearestInt(a.v)); }
TESSERA_INLINE Int truncate_int(Float a) { return Int(hn::ConvertTo(Tag<std::int32_t>(), a.v)); }
#endif

// --- integers only --------------------------------------------------------------------------

TESSERA_INLINE Int abs(Int a) { return Int(hn::Abs(a.v)); }
TESSERA_INLINE Uint abs(Uint a) { return a; }
TESSERA_INLINE Float to_float(Int a) { return Float(hn::ConvertTo(Tag<float>(), a.v)); }
// Both halves and the product are exact, so there is one rounding.
TESSERA_INLINE Float to_float(Uint a) {
    return to_float(as_int(a >> 16)) * Float(65536.0f) + to_float(as_int(a & Uint(0xffffu)));
}
template <class L>
TESSERA_INLINE Vector<L> gather(const L* base, Int index) {
    return Vector<L>(hn::GatherIndex(Tag<L>(), base, index.v));
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE::lanes

namespace tessera {

namespace TESSERA_ISA_NAMESPACE {
using lanes::Float;
using lanes::Int;
using lanes::Mask;
using lanes::Uint;
}  // namespace TESSERA_ISA_NAMESPACE

template <class L>
struct NumberTraits<TESSERA_ISA_NAMESPACE::lanes::Vector<L>> {
    using Lane = L;
    using Float = TESSERA_ISA_NAMESPACE::Float;
    using Int = TESSERA_ISA_NAMESPACE::Int;
    using Uint = TESSERA_ISA_NAMESPACE::Uint;
    using Mask = TESSERA_ISA_NAMESPACE::Mask;
    static constexpr int kLanes = TESSERA_SIMD_LANES;
};

// The functions of vec_plain.h that name their type, such as load<Float>(p).
template <class V>
concept VectorNumber = NumberTraits<V>::kLanes >
1;

template <VectorNumber V>
TESSERA_INLINE V load(const LaneOf<V>* p) {
    return V::load(p);
}
template <VectorNumber V>
TESSERA_INLINE V load_aligned(const LaneOf<V>* p) {
    return V::load_aligned(p);
}
template <VectorNumber V>
TESSERA_INLINE V load_n(const LaneOf<V>* p, int n) {
    return V::load_n(p, n);
}
template <VectorNumber V>
TESSERA_INLINE V iota() {
    return V::iota();
}
template <VectorNumber V>
TESSERA_INLINE MaskOf<V> first_n(int n) {
    return IntOf<V>::iota() < IntOf<V>(n);
}

}  // namespace tessera
