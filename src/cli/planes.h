// Which planes of a picture are wanted (--aov) and what files they become: PNG and the like, .npy arrays, OpenEXR with
// a channel for each number. What a format cannot hold is refused by name before anything is drawn.
#pragma once

#include <tessera/image_files.h>
#include <tessera/planes.h>
#include <tessera/render.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tessera::cli {

enum class Aov {
    kColor,
    kAlpha,
    kDepth,
    kNormal,
    kShadingNormal,
    kUv,
    kPosition,
    kAlbedo,
    kNode,
    kMaterial,
    kPrimitive,
    kMotion,
    kMotionSeen,
};
const char* name(Aov aov);

// Whether the plane has one number a pixel, so that colormaps can show it.
bool is_number_plane(Aov aov);

// One file of every picture.
struct PlaneFile {
    std::string aov;  // what stands for {aov}
    std::vector<Aov> planes;
};

struct PlaneOptions {
    std::string extension = "png";  // of the files, in small letters
    std::vector<PlaneFile> files;   // of each picture
    EncodeOptions encode;
    std::optional<std::array<int, 3>> color_bits;
    std::optional<PaletteOptions> palette;
    std::optional<Colormap> colormap;
    std::optional<ValueRange> range;
    double depth_scale = 1000;  // steps of a 16-bit PNG per metre
};

// What stands behind the last dot of a file's name, in small letters; "png" for stdout, devices and "".
std::string extension_of(const std::string& output);

// The text of the options.
struct PlaneTexts {
    std::string aov = "color", colormap, range, depth_scale, color_bits, palette;
    bool dither = false;
};
// Throws kUsage, naming the option. `output` is the pattern of names, "" for none.
PlaneOptions parse_planes(const PlaneTexts& texts, const std::string& output);

// Asks for what the files are made of.
void want_planes(const PlaneOptions& options, RenderOptions& render);

// Reduces the colour plane as the options say, and notes its hash.
void finish_color(const PlaneOptions& options, RenderResult& result);
// A file of a picture that was finished.
std::vector<std::byte> encode_planes(const PlaneOptions& options, const PlaneFile& file, const RenderResult& result);
// The plane of an AOV.
const Image& plane_of(Aov aov, const RenderResult& result);

}  // namespace tessera::cli
