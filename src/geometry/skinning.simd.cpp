// Skinning, compiled once per instruction set.
#include "geometry/skinning.h"
#include "simd/records.h"

namespace tessera::TESSERA_ISA_NAMESPACE {
namespace {

template <class F>
struct Triple {
    F x, y, z;
};

template <class F>
TESSERA_INLINE Triple<F> cross(const Triple<F>& a, const Triple<F>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class F>
TESSERA_INLINE F dot(const Triple<F>& a, const Triple<F>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
TESSERA_INLINE Triple<F> unit(const Triple<F>& v) {
    const F scale = F(1.0f) / sqrt(max(dot(v, v), F(1e-37f)));
    return {v.x * scale, v.y * scale, v.z * scale};
}

template <class F>
TESSERA_INLINE void store_triples(const Triple<F>& v, float* out) {
    alignas(64) float x[kLanes<F>], y[kLanes<F>], z[kLanes<F>];
    store(x, v.x), store(y, v.y), store(z, v.z);
    for (int i = 0; i < kLanes<F>; ++i) out[3 * i] = x[i], out[3 * i + 1] = y[i], out[3 * i + 2] = z[i];
}

// As many vertices from `v` on as F has lanes.
template <class F>
TESSERA_INLINE void skin_vertices(const SkinJob& job, std::uint32_t v) {
    // The mean of the joints' matrices, rows of it.
    F m[12];
    for (F& number : m) number = F(0.0f);
    for (std::uint32_t set = 0; set < job.sets; ++set) {
        const std::size_t at = 4 * (std::size_t{set} * job.count + v);
        const std::uint32_t* const joints = job.joints + at;
        F weights[4];
        load_records([&](int lane) { return job.weights + at + 4 * lane; }, weights[0], weights[1], weights[2],
                     weights[3]);
        for (int k = 0; k < 4; ++k)
            for (int row = 0; row < 3; ++row) {
                F r[4];
                load_records([&](int lane) { return job.matrices + 12 * std::size_t{joints[4 * lane + k]} + 4 * row; },
                             r[0], r[1], r[2], r[3]);
                for (int c = 0; c < 4; ++c) m[4 * row + c] = m[4 * row + c] + weights[k] * r[c];
            }
    }
    const Triple<F> rows[3] = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}};
    Triple<F> p;
    load_triples(job.positions + 3 * std::size_t{v}, p.x, p.y, p.z);
    store_triples<F>({dot(rows[0], p) + m[3], dot(rows[1], p) + m[7], dot(rows[2], p) + m[11]},
                     job.out_positions + 3 * std::size_t{v});
    if (job.normals) {
        // Cofactors are the inverse transpose times the determinant, whose sign is taken out again.
        const Triple<F> c0 = cross(rows[1], rows[2]), c1 = cross(rows[2], rows[0]), c2 = cross(rows[0], rows[1]);
        const F sign = select(dot(rows[0], c0) < F(0.0f), F(-1.0f), F(1.0f));
        Triple<F> n;
        load_triples(job.normals + 3 * std::size_t{v}, n.x, n.y, n.z);
        const Triple<F> turned = unit<F>({dot(c0, n), dot(c1, n), dot(c2, n)});
        store_triples<F>({turned.x * sign, turned.y * sign, turned.z * sign}, job.out_normals + 3 * std::size_t{v});
    }
    if (job.tangents) {
        Triple<F> t;
        F w;
        load_records([&](int lane) { return job.tangents + 4 * (std::size_t{v} + static_cast<std::size_t>(lane)); },
                     t.x, t.y, t.z, w);
        const Triple<F> moved = unit<F>({dot(rows[0], t), dot(rows[1], t), dot(rows[2], t)});
        store_records(
            [&](int lane) { return job.out_tangents + 4 * (std::size_t{v} + static_cast<std::size_t>(lane)); }, moved.x,
            moved.y, moved.z, w);
    }
}

void skin(const SkinJob& job) {
    std::uint32_t v = job.first;
    for (; v + kLanes<Float> <= job.end; v += kLanes<Float>) skin_vertices<Float>(job, v);
    for (; v < job.end; ++v) skin_vertices<float>(job, v);
}

}  // namespace

const SkinKernels& skin_kernels() {
    static constexpr SkinKernels kKernels{&skin};
    return kKernels;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
