#include "raster/frame_vertices.h"

#include "core/huge_pages.h"

#include <algorithm>
#include <numeric>

namespace tessera {

// Where the vertices of each instance go, and in what parts they are transformed.
void FrameVertices::place(const Frame& frame, const std::vector<std::uint32_t>& in_view) {
    constexpr std::uint32_t kTask = 8192;
    static_assert(kTask % kMaxLanes == 0, "kernels write whole vectors");
    by_instance_.assign(frame.instances.size(), {});
    parts_.clear();
    task_begin_.assign(1, 0);
    std::uint32_t filled = 0;
    std::size_t size = 0, scattered_corners = 0;
    for (const std::uint32_t i : in_view) {
        const DrawnMesh& mesh = *frame.prepared[i];
        const std::size_t corners = 3 * std::size_t{mesh.view.triangle_count};
        const std::uint32_t span = mesh.highest_vertex - mesh.lowest_vertex + 1;
        const bool scattered = span > corners;
        const auto count = scattered ? static_cast<std::uint32_t>(corners) : span;
        if (scattered) scattered_corners = std::max(scattered_corners, corners);
        for (std::uint32_t first = 0; first < count;) {
            const std::uint32_t part = std::min(kTask, count - first);
            parts_.push_back({i, first, part, scattered, size + first});
            first += part;
            filled += part;
            if (filled < kTask) continue;
            task_begin_.push_back(parts_.size());
            filled = 0;
        }
        size += (std::size_t{count} + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
    }
    if (filled > 0) task_begin_.push_back(parts_.size());
    if (numbers_.size() < scattered_corners) {
        numbers_.resize(scattered_corners);
        std::iota(numbers_.begin(), numbers_.end(), 0u);
    }
    if (vertices_.capacity() < size) {
        vertices_.reserve(size);
        prefer_huge_pages(vertices_.data(), size * sizeof(TransformedVertex));
    }
    const TransformedVertex* const all = vertices_.data();
    for (const Part& part : parts_) {
        if (part.first > 0) continue;
        const DrawnMesh& mesh = *frame.prepared[part.instance];
        // So that corners count from the first vertex of the mesh.
        by_instance_[part.instance] =
            part.scattered ? InstanceVertices{all + part.place, numbers_.data()}
                           : InstanceVertices{all + part.place - mesh.lowest_vertex, mesh.view.triangles};
    }
}

void FrameVertices::transform_part(const Frame& frame, const Part& part, const RasterKernels& kernels) {
    const InstanceView& instance = frame.instances[part.instance];
    VertexJob job{};
    job.instance = &instance;
    job.width = frame.projection.width;
    job.height = frame.projection.height;
    job.indices = part.scattered ? instance.mesh.triangles + part.first : nullptr;
    job.first = part.scattered ? 0 : frame.prepared[part.instance]->lowest_vertex + part.first;
    job.count = part.count;
    job.out = vertices_.data() + part.place;
    kernels.transform(job);
}

void FrameVertices::transform(const Frame& frame, const std::vector<std::uint32_t>& in_view,
                              const RasterKernels& kernels, Arena& arena, const std::function<void()>& checkpoint) {
    place(frame, in_view);
    arena.for_each(task_begin_.size() - 1, [&](std::size_t task) {
        checkpoint();
        for (std::size_t p = task_begin_[task]; p < task_begin_[task + 1]; ++p)
            transform_part(frame, parts_[p], kernels);
    });
}

}  // namespace tessera
