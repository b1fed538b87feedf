// Surface records of as many triangles at a time as there are lanes, and samples of them. Part of the
// kernel file, once per instruction set.
#pragma once

#include "simd/records.h"
#include "tile/pixel_kernel.h"
#include "tile/transformed_vertex.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

TESSERA_INLINE SurfaceLayout layout_of(const SurfaceSource& source, const InstanceView& instance) {
    return surface_layout(instance.mesh, source.shading->materials[instance.material], source.projection.orthographic);
}

// The vertices of kLanes triangles, by corner; lanes beyond the last triangle repeat it.
struct LaneVertices {
    std::uint32_t in_mesh[3][kMaxLanes], by_corner[3][kMaxLanes];

    // Of the triangles from `first` on. Asks for what will be read of them, as it is seldom in a cache: neighbours in
    // the list share vertices and lines of the cache, so every other triangle will do, and every fourth one's indices.
    TESSERA_INLINE void find(const SurfaceJob& job, const MeshView& mesh, const InstanceVertices& vertices,
                             const float* normals, std::uint32_t first) {
        constexpr std::uint32_t kWidth = kLanes<Float>, kAhead = 2 * kMaxLanes;
        const std::uint32_t last = job.count - 1;
        const auto triangle = [&](std::uint32_t n)
                                  TESSERA_INLINE_LAMBDA { return 3 * std::size_t{job.triangles[n < last ? n : last]}; };
        for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
            const std::uint32_t* const corners = mesh.triangles + triangle(first + lane);
            in_mesh[0][lane] = corners[0];
            in_mesh[1][lane] = corners[1];
            in_mesh[2][lane] = corners[2];
        }
        for (std::uint32_t lane = 0; lane < kWidth; lane += 4)
            __builtin_prefetch(mesh.triangles + triangle(first + lane + kAhead));
        if (normals)
            for (const auto& lanes : in_mesh)
                for (std::uint32_t lane = 0; lane < kWidth; lane += 2)
                    __builtin_prefetch(normals + 3 * std::size_t{lanes[lane]});
        if (!vertices.corners) {
            for (const auto& lanes : in_mesh)
                for (std::uint32_t lane = 0; lane < kWidth; lane += 2)
                    __builtin_prefetch(mesh.positions + 3 * std::size_t{lanes[lane]});
        } else if (vertices.corners == mesh.triangles) {
            for (const auto& lanes : in_mesh)
                for (std::uint32_t lane = 0; lane < kWidth; lane += 2)
                    __builtin_prefetch(vertices.vertices + lanes[lane]);
        } else {
            for (std::uint32_t lane = 0; lane < kWidth; ++lane)
                for (std::uint32_t k = 0; k < 3; ++k) by_corner[k][lane] = vertices.corners[triangle(first + lane) + k];
        }
    }
};

// The arrays of a mesh that a layout needs.
struct CornerArrays {
    RecordArray<3> positions, normals;
    RecordArray<4> tangents, colors;
    RecordArray<2> uvs[kMaxUvSets];

    CornerArrays(const MeshView& mesh, const SurfaceLayout& l) : positions(mesh.positions, mesh.vertex_count) {
        if (l.normal >= 0) normals = {mesh.normals, mesh.vertex_count};
        if (l.tangent >= 0) tangents = {mesh.tangents, mesh.vertex_count};
        if (l.color >= 0) colors = {mesh.colors, mesh.vertex_count};
        for (int set = 0; set < kMaxUvSets; ++set)
            if (l.uv[set] >= 0) uvs[set] = {mesh.uvs[set], mesh.vertex_count};
    }

    template <int kNumbers>
    static TESSERA_INLINE void load_from(const RecordArray<kNumbers>& array, const std::uint32_t (&vertex)[kMaxLanes],
                                         bool has_last, Float& a, Float& b, Float& c, Float& d) {
        if (has_last) return load_records([&](int lane) { return array.at(vertex[lane]); }, a, b, c, d);
        load_records([&](int lane) { return array.base + std::size_t{vertex[lane]} * kNumbers; }, a, b, c, d);
    }

    // All but the position, which is only read where the layout has the distance along the axis.
    TESSERA_INLINE void load_corner(const SurfaceLayout& l, const std::uint32_t (&vertex)[kMaxLanes],
                                    Corner<Float>& c) const {
        Float unused, unused2;
        const Float zero(0.0f);
        const bool has_last = any(load<Uint>(vertex) == Uint(positions.last));
        c.position = c.normal = {zero, zero, zero};
        c.tangent = c.color = {zero, zero, zero, zero};
        if (l.depth >= 0) load_position(vertex, c.position);
        if (l.normal >= 0) load_from(normals, vertex, has_last, c.normal.x, c.normal.y, c.normal.z, unused);
        if (l.tangent >= 0) load_from(tangents, vertex, has_last, c.tangent.x, c.tangent.y, c.tangent.z, c.tangent.w);
        if (l.color >= 0) load_from(colors, vertex, has_last, c.color.x, c.color.y, c.color.z, c.color.w);
        for (int set = 0; set < kMaxUvSets; ++set) {
            c.uv[set] = {zero, zero};
            if (l.uv[set] >= 0) load_from(uvs[set], vertex, has_last, c.uv[set].x, c.uv[set].y, unused, unused2);
        }
    }
    TESSERA_INLINE void load_position(const std::uint32_t (&vertex)[kMaxLanes], Vec3T<Float>& p) const {
        Float unused;
        load_records([&](int lane) { return positions.at(vertex[lane]); }, p.x, p.y, p.z, unused);
    }
};

// The layouts that most scenes have are constants of the code, which then keeps all planes in
// registers; the others are read from the job.
struct NormalOnly {
    static constexpr bool kColored = false;
    static constexpr SurfaceLayout kLayout{.count = 4, .normal = 1};
    template <class Job>
    static TESSERA_INLINE constexpr const SurfaceLayout& layout(const Job&) {
        return kLayout;
    }
};
struct NormalAndUv {
    static constexpr bool kColored = false;
    static constexpr SurfaceLayout kLayout{.count = 6, .normal = 1, .uv = {4, -1, -1, -1}};
    template <class Job>
    static TESSERA_INLINE constexpr const SurfaceLayout& layout(const Job&) {
        return kLayout;
    }
};
struct ColorOnly {
    static constexpr bool kColored = true;
    static constexpr SurfaceLayout kLayout{.count = 5, .color = 1};
    template <class Job>
    static TESSERA_INLINE constexpr const SurfaceLayout& layout(const Job&) {
        return kLayout;
    }
};
struct AnyLayout {
    static constexpr bool kColored = true;
    template <class Job>
    static TESSERA_INLINE const SurfaceLayout& layout(const Job& job) {
        return job.layout;
    }
};

template <class Kind>
inline void make_surfaces_as(const SurfaceJob& job) {
    constexpr std::uint32_t kWidth = kLanes<Float>;
    const InstanceView& instance = job.source->instances[job.instance];
    const InstanceVertices vertices =
        job.source->vertices ? job.source->vertices[job.instance] : InstanceVertices{nullptr, nullptr};
    const ProjectionView& picture = job.source->projection;
    const SurfaceLayout& layout = Kind::layout(job);
    const int floats = surface_floats(layout);
    const CornerArrays arrays(instance.mesh, layout);
    LaneVertices buffers[2];
    LaneVertices *now = &buffers[0], *next = &buffers[1];
    next->find(job, instance.mesh, vertices, arrays.normals.base, 0);
    for (std::uint32_t t = 0; t < job.count; t += kWidth) {
        float* const records = job.records + std::size_t{t} * static_cast<std::size_t>(floats);
        LaneVertices* const swapped = now;
        now = next;
        next = swapped;
        if (t + kWidth < job.count) next->find(job, instance.mesh, vertices, arrays.normals.base, t + kWidth);
        const LaneVertices& lanes = *now;
        const auto& places =
            !vertices.corners || vertices.corners == instance.mesh.triangles ? lanes.in_mesh : lanes.by_corner;
        Corner<Float> corners[3];
        PictureVertex<Float> p[3];
        Float inverse_w[3];
        Mask special(false);
        TESSERA_UNROLL(3)
        for (int k = 0; k < 3; ++k) {
            Float unused;
            if (vertices.corners) {
                load_records([&](int lane) { return vertices.vertices[places[k][lane]].numbers; }, p[k].x, p[k].y,
                             unused, inverse_w[k]);
            } else {
                Vec3T<Float> at;
                arrays.load_position(lanes.in_mesh[k], at);
                Float numbers[4];
                transform_vertex(to_clip(instance.object_to_clip, at), picture.width, picture.height, numbers);
                p[k].x = numbers[0], p[k].y = numbers[1], inverse_w[k] = numbers[3];
            }
            p[k].snapped_x = nearest_int(p[k].x);
            p[k].snapped_y = nearest_int(p[k].y);
            special |= inverse_w[k] == Float(0.0f);
            arrays.load_corner(layout, lanes.in_mesh[k], corners[k]);
        }
        const auto flat_normal = [&]() TESSERA_INLINE_LAMBDA {
            Vec3T<Float> at[3];
            for (int k = 0; k < 3; ++k) arrays.load_position(lanes.in_mesh[k], at[k]);
            return geometric_normal(instance, at[0], at[1], at[2]);
        };
        // Facing as the exact area says: where float leaves a doubt, the scalar path decides.
        const Float forth = to_float(p[1].snapped_x - p[0].snapped_x) * to_float(p[2].snapped_y - p[0].snapped_y);
        const Float back = to_float(p[2].snapped_x - p[0].snapped_x) * to_float(p[1].snapped_y - p[0].snapped_y);
        const Float area = forth - back;
        const Mask certain = abs(area) > (abs(forth) + abs(back)) * Float(1e-6f);
        // Negative: counter-clockwise as a viewer sees it.
        const Float front = select(area < Float(0.0f), Float(instance.handedness), Float(-instance.handedness));
        Float numbers[kMaxSurfaceFloats];
        numbers[floats - 1] = numbers[floats - 2] = numbers[floats - 3] = Float(0.0f);
        make_planes(instance, layout, corners, inverse_w, p, front, flat_normal,
                    [&](int i, Float v) { numbers[i] = v; });
        for (int i = 0; i < floats; i += 4)
            store_records([&](int lane) { return records + lane * floats + i; }, numbers[i], numbers[i + 1],
                          numbers[i + 2], numbers[i + 3]);
        std::uint32_t again = mask_bits(special | !certain);
        for (; again; again &= again - 1) {
            const auto lane = static_cast<std::uint32_t>(__builtin_ctz(again));
            if (t + lane < job.count)
                job.source->make_record(instance, job.triangles[t + lane], picture, job.layout,
                                        records + static_cast<int>(lane) * floats);
        }
    }
}

inline void make_surfaces(const SurfaceJob& job) {
    if (job.layout == NormalOnly::kLayout) return make_surfaces_as<NormalOnly>(job);
    if (job.layout == NormalAndUv::kLayout) return make_surfaces_as<NormalAndUv>(job);
    make_surfaces_as<AnyLayout>(job);
}

// Where the alpha of one triangle's material says that nothing is there.
TESSERA_INLINE Mask cut_out(const SurfaceSource& source, std::uint32_t instance, const SurfaceLayout& layout,
                            const float* record, Float x, Float y) {
    const MaterialView& material = source.shading->materials[source.instances[instance].material];
    SurfaceSample<Float> sample;
    sample_planes(
        layout, x, y, [record](int i) { return Float(record[i]); }, sample);
    const SurfacePoint<Float> s =
        surface_point(layout, PictureRays(source.projection), sample, x, y, source.shading->footprint_scale);
    return base_color(material, s).w < Float(material.alpha_cutoff);
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
