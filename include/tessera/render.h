// Rendering: a scene, a view and options in, planes of pixels and statistics out. render() keeps no
// global state; any number may run at once. It throws tessera::Error: kUsage for options that make
// no sense, kLimit and kCancelled while rendering. To draw one scene many times: renderer.h.
#pragma once

#include <tessera/export.h>
#include <tessera/image.h>
#include <tessera/isa.h>
#include <tessera/scene.h>
#include <tessera/view.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

enum class Engine : std::uint8_t {
    kRaster,           // tile rasterizer: SIMD, parallel; the same bits as kReferenceRaster
    kTrace,            // packet ray tracer: SIMD, parallel; shadows, mirrored and refracted light
    kHybrid,           // visible surfaces by the rasterizer, light by the ray tracer
    kReferenceRaster,  // z-buffer, scalar, single-threaded: the oracle
    kReferenceTrace,   // recursive ray tracer, scalar, single-threaded: the oracle of the other two
};
TESSERA_API const char* name(Engine engine);

// Where positions and normals of labels live. Turned from one to the other exactly, up to rounding.
enum class LabelSpace : std::uint8_t {
    kWorld,
    kCamera,        // eye at the origin, looking along -Z, Y up
    kOpenCvCamera,  // looking along Z, Y down
};

enum class Lighting : std::uint8_t {
    kAuto,    // the scene's lights, or the studio when it has none
    kScene,   // only the scene's lights
    kStudio,  // three directional lights and ambient light, fixed to the camera
};

// What the samples of a pixel and its neighbours count for its colour, by their distance from its centre.
// The wider ones draw the picture once per sample. Labels are not filtered.
enum class PixelFilter : std::uint8_t {
    kBox,       // the mean of the pixel's own samples
    kTent,      // radius of 1 pixel
    kGaussian,  // radius of 1.5 pixels, sigma of 1/2
    kMitchell,  // radius of 2 pixels: Mitchell and Netravali 1988, B = C = 1/3; sharpest, slight halos
};

// A stage of the tile rasterizer, as a number per pixel. How they come about: docs/rasterizer.md.
enum class Stage : std::uint8_t {
    kPicture,   // none: the picture
    kBins,      // triangles in the pixel's tile
    kHiZ,       // hierarchical Z of its block of 8x8: the lowest reversed depth (0: far), after the last sample
    kOverdraw,  // samples of the pixel that were tested for depth
    kCost,      // cycles that the pixel's tile may have taken: counted and weighed, not timed
};

// How the tile rasterizer works: its speed and its statistics, never a pixel.
struct RasterTuning {
    int tile_side = 0;           // 32, 64 or 128 pixels; 0: chosen by picture and threads
    bool hierarchical_z = true;  // leave out blocks of pixels that are hidden
    bool count_samples = true;   // samples_tested and fragments_passed; costs a few percent
};

// Sizes of points and lines, in pixels.
inline constexpr float kLeastStroke = 0.1f, kMostStroke = 256.0f;

struct RenderOptions {
    int width = 1024, height = 768;  // pixels, 1 .. kMaxImageSide
    Engine engine = Engine::kRaster;
    View view;
    Moment moment;
    Lighting lighting = Lighting::kAuto;
    // Uniform ambient radiance; unset: the scene's, else the studio's own, or a twentieth of the exposed
    // white for a scene's lights.
    std::optional<float> ambient;
    Shadows shadows = Shadows::kAuto;
    int samples = 4;       // per pixel, 1 .. 256, at fixed positions of 1/256 pixel
    float point_size = 2;  // pixels, diameter of points: discs that face the camera, squares up to 2
    float line_width = 1;  // pixels, along the minor axis of the picture (docs/rasterizer.md)
    // Of light that is traced: how often it is mirrored or refracted at most (0: never), and the contribution to a
    // sample below which it is not followed.
    int max_depth = 8;
    float min_contribution = 0.002f;
    std::optional<float> exposure_ev;  // radiance * 2^ev; unset: automatic
    ToneMap tone_map = ToneMap::kNeutral;
    PixelFilter filter = PixelFilter::kBox;
    Encoding encoding = Encoding::kSrgb;                // of the colour plane
    std::optional<Vec4> background = Vec4{1, 1, 1, 1};  // RGB as the colour plane stores it, alpha; unset: transparent
    // In place of the picture the colour plane shows this stage in false colours, black for 0 and white for
    // the most: display codes that neither film nor background touch. Only the tile rasterizer has stages,
    // and not under a filter wider than the pixel. Equal bits for equal tile sides.
    Stage show = Stage::kPicture;
    RasterTuning raster;
    int threads = 0;  // 0: what the process may use
    Isa isa = Isa::kAuto;

    // Planes wanted, as RenderResult describes them. All but the first three are labels, taken at the pixel centre of
    // the nearest surface with alpha of at least one half. Without the first three nothing is shaded, and the
    // statistics count the labels. What is not wanted is not computed.
    bool want_color = true, want_linear = false, want_alpha = false;
    bool want_depth = false, want_primitive = false, want_node = false, want_material = false;
    bool want_normal = false, want_shading_normal = false, want_uv = false, want_position = false, want_albedo = false;
    bool want_motion = false;
    bool euclidean_depth = false;  // distances to the eye instead of along the view axis
    LabelSpace label_space = LabelSpace::kWorld;
    std::optional<Mat4> label_from_world;  // rigid: a world of the host's own for kWorld
    // The shots that motion is measured to; unset: the one that is drawn.
    std::optional<Shot> motion_before, motion_after;

    std::uint64_t max_bytes = std::uint64_t{4} << 30;  // memory that rendering may take
    // Called from any thread, but one call at a time: rising from 0 to 1, and true to stop (render()
    // then throws kCancelled).
    std::function<void(double)> progress;
    std::function<bool()> cancel;
};

struct RenderStats {
    Engine engine = Engine::kReferenceRaster;
    Isa isa = Isa::kScalar;
    int threads = 1;
    std::uint64_t triangles = 0;          // submitted, those made of points and lines included
    std::uint64_t points = 0, lines = 0;  // of the scene; the triangles are of those in view
    std::uint64_t culled_frustum = 0, culled_backface = 0, culled_degenerate = 0, clipped = 0;
    // The tile rasterizer's: triangles that reach no sample, those drawn as masks and by blocks; samples
    // tested for depth; blocks of 8x8 pixels filled, and left out by hierarchical Z.
    std::uint64_t culled_no_sample = 0, small_triangles = 0, large_triangles = 0;
    std::uint64_t samples_tested = 0, blocks_drawn = 0, blocks_hidden = 0;
    int tile_side = 0;                   // pixels
    std::uint64_t pixels_covered = 0;    // with at least one sample hit, or labelled; filtered: of alpha > 0
    std::uint64_t fragments_passed = 0;  // samples that passed the depth test (raster), hits (trace)
    std::uint64_t color_hash = 0;        // hash_pixels() of the colour plane, by render() only
    double exposure = 1;                 // factor on radiance
    // Of traced light: rays by kind (straight: on through blended surfaces); rays that would have gone on but for
    // max_depth and min_contribution; hierarchies of the scene, those built or refitted for this frame, their memory.
    std::uint64_t primary_rays = 0, shadow_rays = 0, mirrored_rays = 0, refracted_rays = 0, straight_rays = 0;
    std::uint64_t ended_by_depth = 0, ended_by_contribution = 0;
    std::uint64_t hierarchies = 0, hierarchies_built = 0, hierarchies_refitted = 0, hierarchy_bytes = 0;
    std::vector<std::pair<std::string, double>> phases_ms;  // wall time by phase, in order
    double frame_ms = 0, cpu_ms = 0;
};

// The planes that were wanted; the others are empty.
struct RenderResult {
    Image color;      // kRgba8, display-ready, straight alpha
    Image linear;     // kRgba32f, scene radiance before exposure, premultiplied alpha, no background;
                      // filtered: kMitchell may leave radiances a little below 0
    Image alpha;      // kF32, the mean alpha of the pixel's samples, which is that of `linear`
    Image depth;      // kF32, metres along the view axis; infinite where nothing was hit
    Image primitive;  // kU32, 1 + number of the triangle, line, point or shape in submission order; 0: none
    Image node;       // kU32, 1 + index into Scene::nodes; 0: none
    Image material;   // kU32, 1 + index into Scene::materials, or 1 + their number for the default; 0: none
    // kRgb32f, unit, on the viewer's side: interpolated, and bent by the normal map. 0 where nothing was hit, like
    // all that follow.
    Image normal, shading_normal;
    Image uv;        // kRg32f: the first set
    Image position;  // kRgb32f, metres
    Image albedo;    // kRgb32f, linear: base or diffuse colour with texture and vertex colour
    // kRgba32f, pixels right and down: from here to where the same point of the surface is at motion_after (x, y), and
    // at motion_before (z, w). 0 where it is behind the eye there.
    Image motion;
    Image motion_seen;  // kU32: 1 where that point is to be seen at motion_after, plus 2 at motion_before
    Image stage;        // the numbers of RenderOptions::show: kU32, or kF32 for kHiZ
    RenderStats stats;
    std::vector<std::string> warnings;
};

TESSERA_API RenderResult render(const Scene& scene, const RenderOptions& options = {});

// World-space box of everything that would be drawn, of the scene as it stands; but for planes without end.
TESSERA_API Bounds3 visible_bounds(const Scene& scene);

}  // namespace tessera
