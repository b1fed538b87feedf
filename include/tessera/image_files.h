// Picture files beyond PNG and JPEG: Radiance HDR, which Tessera reads and writes itself, WebP, and
// OpenEXR and TIFF, which need the OpenImageIO module: a small shared object beside the library that is
// opened the first time one of them is needed. Where it is missing, reading throws kInput and writing
// kOutput, and the message says how to get it. Whole files in memory; the bytes depend on the arguments
// alone (no dates, no names of programs). Any thread may call.
#pragma once

#include <tessera/export.h>
#include <tessera/image.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Whether the OpenImageIO module is there; opens it.
TESSERA_API bool has_image_module();

// --- named channels -------------------------------------------------------------------------

// What a channel stores: 16 or 32 bits of floating point (half rounds to the nearest, ties to even), or
// 32-bit whole numbers.
enum class ChannelType { kHalf, kFloat, kUint };

// One channel of a file to be written. `pixels` points to float values, or to uint32_t values for
// kUint; pixel i, counted row by row from the top left, lies at pixels + i * pixel_stride bytes.
// `name` is "R", "G", "B", "A", or "layer.name" such as "depth.Z": 1 to 255 bytes, none of them 0.
struct ImageChannel {
    std::string name;
    ChannelType type = ChannelType::kFloat;
    const void* pixels = nullptr;
    std::size_t pixel_stride = 4;
};

// An OpenEXR file of scan lines with ZIP compression. By that format's convention R, G and B are
// linear and premultiplied by A. Throws kUsage for an empty list, equal names and sides outside
// 1 .. kMaxImageSide.
TESSERA_API std::vector<std::byte> encode_exr(int width, int height, std::span<const ImageChannel> channels);

// A channel that was read: kF32 pixels for kHalf and kFloat, kU32 for kUint.
struct ImagePlane {
    std::string name;
    ChannelType type = ChannelType::kFloat;
    Image pixels;
};
// All channels of an OpenEXR file, ordered by name as in the file. Files of several parts and deep
// files are refused (kInput), and so are channels with fewer pixels than the picture. `max_pixels` counts
// the pixels of the picture; their number times that of the channels may be 4 times as many.
TESSERA_API std::vector<ImagePlane> decode_exr_channels(std::span<const std::byte> file,
                                                        std::uint64_t max_pixels = 1u << 28);

// Those of the file at `path`; none when it is no OpenEXR file. The error names it.
TESSERA_API std::vector<ImagePlane> read_exr_channels(const std::string& path, std::uint64_t max_pixels = 1u << 28);

// As compare_images(), over all channels: a pixel differs when any channel differs by more than
// `tolerance`, in the channel's own unit. Both lists must have the same names in the same order, and all
// planes the same size (kUsage otherwise).
TESSERA_API ImageDifference compare_planes(std::span<const ImagePlane> a, std::span<const ImagePlane> b,
                                           double tolerance = 0);

// --- pictures -------------------------------------------------------------------------------

// Radiance RGBE (run-length encoded) of a kRgba32f image; alpha is dropped. A pixel becomes three bytes
// with the power of two of its largest channel, which rounds to the nearest step of 1/256 of that
// power. Negative values and NaN become 0, values too large the largest.
TESSERA_API std::vector<std::byte> encode_hdr(const Image& rgba32f);

// kRgba8 or kRgba16 (straight alpha) or kRgba32f (premultiplied); ZIP compression; without alpha when
// every pixel is opaque.
TESSERA_API std::vector<std::byte> encode_tiff(const Image& image);

struct WebpOptions {
    bool lossless = true;
    int quality = 90;  // 1 .. 100, when not lossless
};
// kRgba8 of at most 16383 pixels a side.
TESSERA_API std::vector<std::byte> encode_webp(const Image& rgba8, const WebpOptions& options = {});

struct EncodeOptions {
    PngOptions png = {};
    int jpeg_quality = 92;
    WebpOptions webp = {};
    ChannelType exr_type = ChannelType::kHalf;  // kHalf or kFloat
};
// Chooses the codec by `extension` (any case, with or without the dot): png, jpg, jpeg, tif, tiff, webp
// of kRgba8 (png and tif of kRgba16, too), and exr, hdr, tif of kRgba32f. Other formats of image are
// refused (kUsage), and so are other extensions (kOutput).
TESSERA_API std::vector<std::byte> encode_image(const std::string& extension, const Image& image,
                                                const EncodeOptions& options = {});

// What an extension stands for; so that a caller can refuse one before it renders.
enum class FileContent { kUnknown, kDisplay, kLinear };
// kDisplay: png, jpg, jpeg, tif, tiff, webp; kLinear: exr, hdr.
TESSERA_API FileContent file_content(const std::string& extension);

}  // namespace tessera
