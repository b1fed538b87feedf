// What the stages of the rasterizer hand to each other and to their kernels: plain data. Picture
// coordinates in 24.8 fixed point (1/256 pixel, y down), depth reversed. docs/rasterizer.md explains
// the formats.
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

// --- the front end ----------------------------------------------------------------------------

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

// Transforms `count` vertices: consecutive ones from `first`, or where `indices` is set those.
struct VertexJob {
    const InstanceView* instance;
    float width, height;
    const std::uint32_t* indices;
    std::uint32_t first, count;
    TransformedVertex* out;  // padded to kMaxLanes
};

// A triangle whose samples fit 8x8 pixels: all of its coverage as a mask (bit 8 * row + column, from
// pixel (x, y)), not clipped to the picture's right and bottom. One sample per pixel.
struct SmallTriangle {
    DepthPlane<float> depth;
    std::uint32_t position;  // x | y << 16
    std::uint32_t rows[2];   // rows 0 .. 3 and 4 .. 7
    std::uint32_t triangle;  // within its instance
    std::uint32_t instance;
};
static_assert(sizeof(SmallTriangle) == 48);

// Any other triangle, or a piece of a clipped one.
struct LargeTriangle {
    SnappedVertex v[3];  // clockwise on the screen
    DepthPlane<float> depth;
    std::uint32_t triangle;
    std::uint32_t instance;
};

// Consecutive triangles of a chunk that one tile draws: small ones, or large ones.
struct BinRun {
    static constexpr std::uint32_t kLarge = 0x80000000u;
    std::uint32_t first, count;  // count | kLarge

    TESSERA_INLINE std::uint32_t size() const { return count & ~kLarge; }
    TESSERA_INLINE bool large() const { return (count & kLarge) != 0; }
};

struct FrontCounters {
    std::uint64_t frustum = 0, backface = 0, degenerate = 0, clipped = 0, no_sample = 0, small = 0, large = 0;
};

// Triangles and runs of a chunk as they grow, in the order of submission. The arrays belong to the
// front end, which makes them larger when the kernel asks.
struct ChunkArrays {
    SmallTriangle* small;
    LargeTriangle* large;
    BinRun* runs;
    std::uint32_t* run_tiles;  // the tile of every run
    std::uint32_t small_count, large_count, run_count;
    std::uint32_t small_capacity, large_capacity, run_capacity;

    // How many more triangles fit of either kind, small ones with the four runs that they may need.
    TESSERA_INLINE std::uint32_t room() const {
        const std::uint32_t small_room = small_capacity - small_count, large_room = large_capacity - large_count;
        const std::uint32_t run_room = (run_capacity - run_count) / 4;
        const std::uint32_t least = small_room < large_room ? small_room : large_room;
        return least < run_room ? least : run_room;
    }
};

// Set-up and binning of consecutive triangles of one instance.
struct SetupJob {
    const InstanceView* instance;
    float width, height;
    std::uint32_t instance_index, first, count;
    bool double_sided;
    bool one_sample;  // then `sample` is its position, and triangles that reach none are dropped
    bool masks;       // small triangles may become masks
    SamplePosition sample;
    int tile_shift, tile_columns;
    InstanceVertices vertices;
    ChunkArrays arrays;
    FrontCounters counters;
    // Makes room for kMaxLanes more triangles of each kind and their runs.
    void (*reserve)(SetupJob& job);
    // Bins the last of arrays.large.
    void (*bin_large)(SetupJob& job);
    // Takes a triangle (within the instance) that is clipped, or too large for 32-bit areas.
    void (*set_up_slowly)(SetupJob& job, std::uint32_t triangle);
    void* owner;
};

// --- tiles ------------------------------------------------------------------------------------

// What one chunk has for one tile.
struct TileBin {
    const SmallTriangle* small;
    const LargeTriangle* large;
    const BinRun* runs;
    std::uint32_t run_count;
};

// Where a triangle of a tile comes from.
struct TileTriangle {
    std::uint32_t triangle, instance;
};

// What kernels need to make surface records and shade them.
struct SurfaceSource {
    const InstanceView* instances;
    const InstanceVertices* vertices;  // by instance
    const ShadingContext* shading;
    ProjectionView projection;
    // The scalar path, for triangles that are clipped.
    void (*make_record)(const InstanceView& instance, std::uint32_t triangle, const ProjectionView& projection,
                        const SurfaceLayout& layout, float* record);
};

struct TileCounters {
    std::uint64_t samples_covered = 0;   // inside a triangle and tested for depth
    std::uint64_t fragments_passed = 0;  // and in front
    // Of large triangles; a triangle that the whole tile hides counts as one.
    std::uint64_t blocks_drawn = 0, blocks_hidden = 0;
};

// Coverage and depth of a tile at one sample position per pixel. Ordinals count the tile's triangles
// from 1 in the order of submission; 0 is nothing.
struct VisibilityJob {
    int x0, y0;  // first pixel
    int side;    // of the tile
    SamplePosition offset;
    const TileBin* bins;
    std::uint32_t bin_count;
    const SurfaceSource* source;
    bool hierarchical_z, count;
    float* depth;             // by pixel; infinite outside the picture
    std::uint32_t* ordinal;   // by pixel
    float* floor;             // by block: no depth in it is lower
    TileTriangle* triangles;  // out: by ordinal - 1
    TileCounters counters;
    // Receives one transparent fragment.
    void (*add_fragment)(void* owner, std::uint32_t pixel, std::uint32_t ordinal, float depth);
    void* owner;
    std::uint32_t* overdraw;  // by pixel: samples that were tested; null where not wanted
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

struct RasterKernels {
    void (*transform)(const VertexJob& job);
    void (*setup)(SetupJob& job);
    void (*visibility)(VisibilityJob& job);
    void (*find_visible)(VisibleJob& job);
    void (*make_surfaces)(const SurfaceJob& job);
    void (*shade_tile)(const ShadeJob& job);
    void (*shade_points)(const ShadeJob& job);
    void (*develop)(const DevelopJob& job);
    void (*label)(const LabelJob& job);
    void (*label_surfaces)(const LabelSurfaceJob& job);
};

}  // namespace tessera
