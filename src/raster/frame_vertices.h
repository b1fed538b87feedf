// The vertices of a frame in the picture: those of every instance in view are transformed in parallel, and stay
// for set-up and for the surface records of the tiles. Memory is kept from frame to frame. One frame at a time.
#pragma once

#include "core/parallel.h"
#include "geometry/frame.h"
#include "raster/kernels.h"
#include "tile/buffer.h"

#include <functional>
#include <vector>

namespace tessera {

class FrameVertices {
  public:
    // `in_view`: instances, each once. `checkpoint` is called by the tasks; may throw.
    void transform(const Frame& frame, const std::vector<std::uint32_t>& in_view, const RasterKernels& kernels,
                   Arena& arena, const std::function<void()>& checkpoint);

    // By instance; nothing for those that are not in view.
    const InstanceVertices* by_instance() const { return by_instance_.data(); }

  private:
    // Vertices of one instance, or its corners where the mesh names few vertices among many.
    struct Part {
        std::uint32_t instance, first, count;
        bool scattered;
        std::size_t place;  // in vertices_
    };

    void place(const Frame& frame, const std::vector<std::uint32_t>& in_view);
    void transform_part(const Frame& frame, const Part& part, const RasterKernels& kernels);

    std::vector<Part> parts_;
    std::vector<std::size_t> task_begin_;  // first part of every task, and the end
    Buffer<TransformedVertex> vertices_;
    std::vector<InstanceVertices> by_instance_;
    std::vector<std::uint32_t> numbers_;  // 0, 1, 2, ...: the corners of instances whose vertices are scattered
};

}  // namespace tessera
