#include "shading/chain.h"

namespace tessera::TESSERA_ISA_NAMESPACE {
namespace {

constexpr int kWidth = kLanes<Float>;

// Reads and writes one plane after the other.
struct Reader {
    const float* p;
    int stride;
    TESSERA_INLINE Float next() {
        const Float v = load<Float>(p);
        p += stride;
        return v;
    }
    TESSERA_INLINE Vec2T<Float> next2() {
        const Float x = next();
        return {x, next()};
    }
    TESSERA_INLINE Vec3T<Float> next3() {
        const Float x = next(), y = next();
        return {x, y, next()};
    }
    TESSERA_INLINE Vec4T<Float> next4() {
        const Float x = next(), y = next(), z = next();
        return {x, y, z, next()};
    }
};

struct Writer {
    std::uint32_t* p;
    int stride;
    TESSERA_INLINE void put(Uint v) {
        store(p, v);
        p += stride;
    }
    TESSERA_INLINE void put(Int v) { put(as_uint(v)); }
    TESSERA_INLINE void put(Float v) { put(as_uint(v)); }
    TESSERA_INLINE void put(const Vec3T<Float>& v) {
        put(v.x);
        put(v.y);
        put(v.z);
    }
};

TESSERA_INLINE Int bounded(Int i) { return min(max(i, Int(-(1 << 24))), Int(1 << 24)); }

// A ray's hit: the point at barycentrics made from the sample.
TESSERA_INLINE void put_hit(const ChainJob& job, const Corner<Float> (&corners)[3], Float x, Float y, Writer& out) {
    Barycentrics<Float> b;
    b.b[1] = x * Float(0.5f / (256.0f * job.projection->width));
    b.b[2] = y * Float(0.5f / (256.0f * job.projection->height));
    b.b[0] = Float(1.0f) - b.b[1] - b.b[2];
    for (int i = 0; i < 3; ++i) {
        b.ddx[i] = b.b[i] - b.b[(i + 1) % 3];
        b.ddy[i] = b.b[i] - b.b[(i + 2) % 3];
    }
    const SurfacePoint<Float> s =
        surface_point(*job.instance, corners, b, {x, y, b.b[0]}, Float(-1.0f), job.context->footprint_scale);
    out.put(s.position);
    out.put(s.view);
    out.put(s.geometric_normal);
    out.put(s.normal);
    out.put(s.tangent);
    out.put(s.uv[1].x);
    out.put(s.footprint[1].ux);
    out.put(s.footprint[1].vy);
    out.put(s.color.w);
}

void shade_batch(const ChainJob& job, int first) {
    Reader in{job.planes + first, job.stride};
    Writer out{job.results + first, job.stride};
    Corner<Float> corners[3];
    ClipVertex<Float> clip[3];
    for (int i = 0; i < 3; ++i) {
        Corner<Float>& c = corners[i];
        c.position = in.next3();
        c.normal = in.next3();
        c.tangent = in.next4();
        c.color = in.next4();
        for (int k = 0; k < kMaxUvSets; ++k) c.uv[k] = in.next2();
        clip[i] = to_clip(job.instance->object_to_clip, c.position);
    }
    const Int x = to_int(in.next()), y = to_int(in.next());

    for (int i = 0; i < 3; ++i) out.put(out_code(clip[i]));
    PictureVertex<Float> picture[3];
    Float z[3];
    for (int i = 0; i < 3; ++i) {
        picture[i] = to_picture(clip[i], job.projection->width, job.projection->height);
        // Vertices behind the eye snap anywhere; differences must not overflow.
        picture[i].snapped_x = bounded(picture[i].snapped_x);
        picture[i].snapped_y = bounded(picture[i].snapped_y);
        z[i] = clip[i].z / clip[i].w;
        out.put(picture[i].snapped_x);
        out.put(picture[i].snapped_y);
    }
    const DepthPlane<Float> depth = depth_plane(picture, z);
    out.put(depth.ddx);
    out.put(depth.ddy);
    out.put(depth.at(x, y));

    const Float area =
        to_float(picture[1].snapped_x - picture[0].snapped_x) * to_float(picture[2].snapped_y - picture[0].snapped_y) -
        to_float(picture[2].snapped_x - picture[0].snapped_x) * to_float(picture[1].snapped_y - picture[0].snapped_y);
    const Float orientation = select(area < Float(0.0f), Float(1.0f), Float(-1.0f));
    const Float front = orientation * Float(job.instance->handedness);
    Float record[kMaxSurfaceFloats];
    for (Float& number : record) number = Float(0.0f);
    make_planes(*job.instance, job.layout, corners, clip, picture, front, [&](int i, Float v) { record[i] = v; });
    for (const Float v : record) out.put(v);

    SurfaceSample<Float> sample;
    sample_planes(
        job.layout, to_float(x), to_float(y), [&record](int i) { return record[i]; }, sample);
    SurfacePoint<Float> s = surface_point(job.layout, PictureRays(*job.projection), sample, to_float(x), to_float(y),
                                          job.context->footprint_scale);
    out.put(s.position);
    out.put(s.geometric_normal);
    out.put(s.normal);
    out.put(s.tangent);
    out.put(s.bitangent);
    for (int k = 0; k < 2; ++k) {
        out.put(s.uv[k].x);
        out.put(s.uv[k].y);
        out.put(s.footprint[k].ux);
        out.put(s.footprint[k].vx);
        out.put(s.footprint[k].uy);
        out.put(s.footprint[k].vy);
    }
    if (job.layout.tangent >= 0) s.normal = shading_normal(*job.material, s);
    const LobeParameters<Float> p = evaluate_material(*job.material, s);
    out.put(p.normal);
    out.put(p.view);
    out.put(p.n_v);
    out.put(p.base);
    out.put(p.alpha);
    out.put(p.metallic);
    out.put(p.roughness);
    out.put(p.occlusion);

    // Shadows in steps, by distance and by light.
    const ShadedPoint<Float> shaded =
        shade(*job.context, *job.material, s, [](int light, const LightSample<Float>& arriving) {
            return select(arriving.distance > Float(3.0f + static_cast<float>(light)), Float(0.25f), Float(1.0f));
        });
    out.put(shaded.radiance);
    out.put(shaded.alpha);
    for (int i = 0; i < 3; ++i) {
        const DisplayPixel<Float> d = develop(job.films[i], shaded.radiance * shaded.alpha, shaded.alpha);
        out.put(d.r);
        out.put(d.g);
        out.put(d.b);
        out.put(d.a);
    }
    put_hit(job, corners, to_float(x), to_float(y), out);
}

void run(const ChainJob& job) {
    for (int i = 0; i < job.count; i += kWidth) shade_batch(job, i);
}

}  // namespace

const ChainTable& chain_table() {
    static constexpr ChainTable kTable{&run, kWidth};
    return kTable;
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
