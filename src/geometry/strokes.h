// Points and lines as triangles that face the camera, made anew for every frame, so that engines and labels need
// to know nothing of them. A segment becomes a parallelogram, as wide as the line along the picture's minor axis, a
// point a regular polygon. Their vertices lie in a space of the picture's own: (x, y, w) of clip space with
// perspective, (x, y, z) without, where each of them snaps to exactly the 24.8 position that it is meant to have.
// docs/rasterizer.md has the definition. One thread at a time per StrokeMesh, which uses its memory again.
#pragma once

#include "geometry/picture_vertex.h"
#include "geometry/prepared_mesh.h"
#include "geometry/projection.h"

#include <cstdint>
#include <vector>

namespace tessera {

// Sizes in pixels, as in RenderOptions.
struct StrokeStyle {
    float point_size = 2, line_width = 1;
    std::uint64_t max_bytes = std::uint64_t{4} << 30;  // for all that a frame makes of points and lines
};

// A position in the picture, or a distance in it, in 1/256 pixel.
struct PictureOffset {
    std::int32_t x, y;
};

// What all strokes of a frame share.
struct StrokeSpace {
    StrokeSpace(const FrameCamera& camera, const StrokeStyle& style);

    float to_clip[16], to_camera[12];  // from that space; rows, as InstanceView has them
    float width, height;               // of the picture, pixels
    bool orthographic;
    double inverse_scale;  // times w of the instances' clip space: the distance along the axis
    // Half pictures from the centre: lines are cut there, and points beyond are not seen.
    double guard, point_guard;
    std::int32_t line_low, line_high;    // from a line to its sides
    std::vector<PictureOffset> corners;  // of a point, counter-clockwise as a viewer sees them
};

// What is made of consecutive points or segments of one primitive.
class StrokeMesh : public DrawnMesh {
  public:
    StrokeMesh() = default;
    StrokeMesh(const StrokeMesh&) = delete;
    StrokeMesh& operator=(const StrokeMesh&) = delete;

    // Makes the elements (element_count()) first .. first + count - 1 of a mesh as `instance` places it, but for those
    // that lie outside of the picture.
    void make(const InstanceView& instance, const PreparedMesh& mesh, std::uint32_t first, std::uint32_t count,
              const StrokeSpace& space);
    // What the latest make() filled.
    std::uint64_t bytes() const;

  private:
    // Where the attributes of a vertex come from: on the way from one of the primitive's to another.
    struct Source {
        std::uint32_t from, to;
        double t;
    };
    struct End;

    void clear();
    void add_point(std::uint32_t element, std::uint32_t vertex, const StrokeSpace& space);
    void add_segment(std::uint32_t element, std::uint32_t from, std::uint32_t to, const StrokeSpace& space);
    void add_vertex(float x, float y, const End& end);
    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        triangles_.insert(triangles_.end(), {a, b, c});
    }
    ClipVertex<float> clip_vertex(std::uint32_t vertex) const;
    void set_view(std::uint32_t triangles_per_element, bool lines);

    const InstanceView* instance_ = nullptr;  // while it makes
    std::vector<float> positions_, normals_, colors_, uvs_[kMaxUvSets];
    std::vector<std::uint32_t> triangles_, elements_;
    std::vector<std::uint8_t> ties_;
};

}  // namespace tessera
