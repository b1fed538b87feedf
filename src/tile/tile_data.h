// What an engine hands to the tiles, and tiles to their kernels: plain data. A tile turns what is visible in it into
// pixels; raster/ and trace/ say what is visible. Picture coordinates in 24.8 fixed point (1/256 pixel, y down), depth
// reversed.
#pragma once

#include "shading/film.h"
#include "shading/label_point.h"
#include "shading/shade.h"
#include "shading/surface_planes.h"
#include "shading/triangle_setup.h"

#include <cstdint>

namespace tessera {

// A tile's pixels lie as blocks of 8x8, row after row of blocks, 64 numbers of a block together.
inline constexpr int kBlockSide = 8;
inline constexpr int kBlockPixels = kBlockSide * kBlockSide;
inline constexpr int kMaxTileSide = 128;
inline constexpr int kMaxTilePixels = kMaxTileSide * kMaxTileSide;
// The widest vectors; arrays that kernels read are padded to a multiple of it.
inline constexpr int kMaxLanes = 16;

// A vertex in the picture: position (x, y) in 1/256 pixel before snapping, z / w and 1 / w. Where its
// triangles need the scalar path: 0, 0, the bits of its out-codes, and 0. 16 bytes: one load.
struct TransformedVertex {
    float numbers[4];
};
// Besides the out-codes: coordinates beyond any use.
inline constexpr std::uint32_t kUnusable = 128;

// The vertices of an instance, for as long as the frame is drawn.
struct InstanceVertices {
    const TransformedVertex* vertices;
    const std::uint32_t* corners;  // three per triangle, into `vertices`
};

// Where a triangle of a tile comes from.
struct TileTriangle {
    std::uint32_t triangle, instance;
};

// What kernels need to make surface records and shade them.
struct SurfaceSource {
    const InstanceView* instances;
    const InstanceVertices* vertices;  // by instance; null: transformed where they are needed
    const ShadingContext* shading;
    ProjectionView projection;
    // The scalar path, for triangles that are clipped.
    void (*make_record)(const InstanceView& instance, std::uint32_t triangle, const ProjectionView& projection,
                        const SurfaceLayout& layout, float* record);
};

// Which ordinals are seen: each once, in order.
struct VisibleJob {
    const std::uint32_t* ordinal;
    int pixels;
    std::uint32_t triangle_count;
    std::uint8_t* seen;   // triangle_count + 1, cleared by the kernel
    std::uint32_t* list;  // out
    std::uint32_t count;  // out
};

// Makes the surface records of triangles of one instance, one after the other.
struct SurfaceJob {
    const SurfaceSource* source;
    std::uint32_t instance;
    SurfaceLayout layout;
    const std::uint32_t* triangles;  // within the instance
    std::uint32_t count;
    float* records;  // padded by kMaxLanes records
};

// Surface points of one material and layout to shade.
struct ShadeJob {
    const SurfaceSource* source;
    const MaterialView* material;
    SurfaceLayout layout;
    const float* records;
    const std::uint32_t* record_of;  // by ordinal: where in `records`
    // A whole tile: every pixel with an ordinal, at the sample offset.
    int x0, y0, side;
    SamplePosition offset;
    const std::uint32_t* ordinal;
    bool first;                        // store the sums instead of adding to them
    const struct DevelopJob* develop;  // one sample a pixel: develop at once, without sums; else null
    std::uint64_t* hit;                // by block: bit per pixel
    // Or a list of points, padded to kMaxLanes.
    const std::int32_t *x, *y;  // picture positions
    const std::uint32_t* list;  // ordinals
    std::uint32_t count;
    float *r, *g, *b, *alpha;  // by pixel, or by point
};

// Where a tile lies in planes of the picture that have four bytes a pixel.
struct TileWindow {
    int side, width, height;  // width and height: within the picture
    std::size_t stride;       // bytes from row to row
    // Whole cache lines go past the caches: the tile's first pixel and the stride are multiples of them. For planes
    // that do not stay there.
    bool streamed;
};

// Develops a tile: sums over the samples in, display values out. Without sums (r is null): background.
struct DevelopJob {
    FilmView film;
    float weight;  // one over the number of samples
    const float *r, *g, *b, *alpha;
    TileWindow window;
    std::uint8_t* rgba;  // the tile's first pixel
};

// Planes of labels, null where not wanted. Misses: an infinite distance, all else 0.
struct LabelPlanes {
    float* distance;                                     // metres along the view axis, or to the eye
    std::uint32_t* triangle;                             // 1 + number in the frame
    std::uint32_t* primitive;                            // 1 + number of the point, line or triangle in the scene
    std::uint32_t *node, *material;                      // 1 + index
    float *normal, *shading_normal, *position, *albedo;  // three numbers a pixel
    float* uv;                                           // two

    TESSERA_INLINE bool any() const {
        return distance || triangle || primitive || node || material || normal || shading_normal || position ||
               albedo || uv;
    }
};

// Writes labels of a tile from its depth and ordinals: distances and numbers. Without ordinals: of a tile that shows
// nothing.
struct LabelJob {
    ProjectionView projection;
    int x0, y0;  // first pixel
    bool euclidean;
    const float* depth;
    const std::uint32_t* ordinal;
    const TileTriangle* triangles;
    const InstanceView* instances;
    TileWindow window;
    LabelPlanes planes;  // from the tile's first pixel on
};

// Labels of the surface, of triangles that share a layout and, where it has a say, the material: every pixel of the
// tile with an ordinal, at its centre.
struct LabelSurfaceJob {
    const SurfaceSource* source;
    const MaterialView* material;
    SurfaceLabels labels;
    SurfaceLayout layout;
    const float* records;
    const std::uint32_t* record_of;  // by ordinal: where in `records`
    int x0, y0, side;
    const std::uint32_t* ordinal;
    const float* depth;              // by pixel
    const float* label_from_camera;  // 3x4 rows
    std::size_t picture_width;
    LabelPlanes planes;  // from the tile's first pixel on
};

struct TileKernels {
    void (*find_visible)(VisibleJob& job);
    void (*make_surfaces)(const SurfaceJob& job);
    void (*shade_tile)(const ShadeJob& job);
    void (*shade_points)(const ShadeJob& job);
    void (*develop)(const DevelopJob& job);
    void (*label)(const LabelJob& job);
    void (*label_surfaces)(const LabelSurfaceJob& job);
};

}  // namespace tessera
