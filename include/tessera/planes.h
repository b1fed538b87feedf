// Planes of numbers as exact files and as colours: NumPy arrays, 16-bit grey and packed PNG, named
// colormaps, index planes with a palette (pseudo colour). A plane is an Image of kF32 or kU32; colours
// are 8-bit display codes (sRGB). All is basic arithmetic, so the bits are the same on every machine.
// Everything throws tessera::Error: kUsage for arguments that make no sense, kLimit for a value that a
// format cannot hold (the message names it), kInput for damaged files. Any thread may call.
#pragma once

#include <tessera/export.h>
#include <tessera/image.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// --- NumPy arrays (.npy) ----------------------------------------------------------------------

enum class NpyType : std::uint8_t { kU1, kU2, kU4, kF2, kF4 };  // |u1 <u2 <u4 <f2 <f4
TESSERA_API const char* name(NpyType type);                     // as above
// Bytes of one value: 1, 2, 4, 2, 4.
TESSERA_API std::size_t bytes_per_value(NpyType type);

// NumPy's format 1.0, little-endian, in C order: shape (height, width) for one component, else
// (height, width, components). `values` are width * height * components values, row by row from the top
// left, components together; kF2 as the bits of IEEE halves. Sides 1 .. kMaxImageSide, components 1 .. 64.
TESSERA_API std::vector<std::byte> encode_npy(int width, int height, int components, NpyType type, const void* values);
// An Image as it is: kF32 <f4 and kU32 <u4 of (h, w); kRg32f <f4 of (h, w, 2), kRgb32f of (h, w, 3); kRgba8 |u1,
// kRgba16 <u2, kRgba32f <f4 of (h, w, 4).
TESSERA_API std::vector<std::byte> encode_npy(const Image& image);

struct NpyArray {
    int width = 0, height = 0, components = 1;
    NpyType type = NpyType::kF4;
    std::vector<std::byte> values;
};
TESSERA_API bool is_npy(std::span<const std::byte> file);
// Reads what encode_npy() writes and NumPy's save() of such arrays (formats 1.0 to 3.0). Other types,
// big-endian and Fortran order are refused by name (kInput). Throws kLimit when width * height exceeds
// `max_pixels`, before memory is taken; the file must be as long as its header says.
TESSERA_API NpyArray decode_npy(std::span<const std::byte> file, std::uint64_t max_pixels = 1u << 28);
// Reads and decodes a file; the error names it.
TESSERA_API NpyArray read_npy(const std::string& path, std::uint64_t max_pixels = 1u << 28);
// As compare_images(), over arrays of the same shape and type (kUsage otherwise); `tolerance` and errors
// are in the unit of the values. The PSNR takes 1 as the peak of floats, all bits set of integers.
TESSERA_API ImageDifference compare_arrays(const NpyArray& a, const NpyArray& b, double tolerance = 0);

// --- exact PNG --------------------------------------------------------------------------------

// kU32 as 16-bit grey, value for value. Throws kLimit, naming the largest value, above 65535.
TESSERA_API std::vector<std::byte> encode_grey_png(const Image& plane, const PngOptions& options = {});
// kF32 metres as 16-bit grey: metres * scale (1000: millimetres), rounded half to even. 0 is where nothing
// was hit (infinite or NaN), as depth cameras write it; a hit is at least 1. Throws kLimit, naming the
// largest depth, when one comes out above 65535 or below 0.
TESSERA_API std::vector<std::byte> encode_depth_png(const Image& depth, double scale = 1000,
                                                    const PngOptions& options = {});
// kU32 as 8-bit RGB, id = R + 256 G + 65536 B (as COCO's panoptic labels), when every id has 24 bits,
// else as RGBA with A the highest byte. The colour type of the file tells which.
TESSERA_API std::vector<std::byte> encode_id_png(const Image& ids, const PngOptions& options = {});
// The ids of such a file.
TESSERA_API Image decode_id_png(std::span<const std::byte> file, std::uint64_t max_pixels = 1u << 28);

// --- index planes (FB2) -----------------------------------------------------------------------

struct Rgba8 {
    std::uint8_t r = 0, g = 0, b = 0, a = 255;
    friend bool operator==(const Rgba8&, const Rgba8&) = default;
};

// An N-bit index plane with a colormap of at most 2^N entries.
struct IndexedImage {
    int width = 0, height = 0;
    int bits = 8;                       // N: 1 .. 8; every index is below the number of entries
    std::vector<std::uint8_t> indices;  // one byte a pixel, row by row from the top left
    std::vector<Rgba8> colormap;        // 1 .. 2^bits entries, straight alpha
};
// The entry of every pixel, as kRgba8.
TESSERA_API Image to_rgba8(const IndexedImage& image);
// The entries reduced to w = red_bits + green_bits + blue_bits bits (1 .. 8 each), as by quantize_true_color().
TESSERA_API IndexedImage quantize_entries(IndexedImage image, int red_bits, int green_bits, int blue_bits);
// Palette PNG (colour type 3) of 1, 2, 4 or 8 bits a pixel, the fewest that the number of entries allows,
// with tRNS where an entry is not opaque.
TESSERA_API std::vector<std::byte> encode_png(const IndexedImage& image, const PngOptions& options = {});

// --- colormaps --------------------------------------------------------------------------------

enum class Colormap : std::uint8_t {
    kGrey,     // entry i is (i, i, i)
    kViridis,  // Smith and van der Walt 2015: lightness rises evenly, for every kind of colour vision
    kMagma,    // the same from black over purple to pale yellow
    kTurbo,    // Mikhailov 2019: a rainbow without false edges; lightness rises, then falls
    kIds,      // kU32 only: a colour of its own for each number, see id_color(); takes no range
};
TESSERA_API const char* name(Colormap map);  // "grey", "viridis", "magma", "turbo", "ids"
TESSERA_API std::optional<Colormap> colormap_named(std::string_view name);
// The 256 entries, from low to high. kIds: the colours of the numbers 0 .. 255.
TESSERA_API const std::array<Rgba8, 256>& entries(Colormap map);

// 0 is black. Otherwise the hue is id * 0x9e3779b9 mod 2^32 as a fraction of the circle (steps of the golden
// ratio: neighbours are 137.5 degrees apart), saturation and brightness, never dark, come from bits of
// MurmurHash3's 32-bit finalizer of the id.
TESSERA_API Rgba8 id_color(std::uint32_t id);

struct ValueRange {
    double low = 0, high = 1;
    friend bool operator==(const ValueRange&, const ValueRange&) = default;
};
// Least and largest finite value of a kF32 or kU32 plane; nothing when there is none.
TESSERA_API std::optional<ValueRange> finite_range(const Image& plane);

// The plane in colours: the range (default: finite_range()) is cut into 256 equal steps, an entry each; values
// beyond take the first or last entry, and all the first when low = high. What is not finite becomes transparent
// black. kUsage for a range that is not finite or runs backwards. kRgba8.
TESSERA_API Image apply_colormap(const Image& plane, Colormap map, std::optional<ValueRange> range = {});
// The same as an index plane of `bits` (1 .. 8) bits: 2^bits equal steps, whose colours are the map's at evenly
// spaced entries from its first to its last. Where a value is not finite, entry 0 is transparent black and 2^bits - 1
// steps follow it. kIds is refused, unless every number is below 2^bits: then the index is the number.
TESSERA_API IndexedImage index_plane(const Image& plane, Colormap map, int bits = 8,
                                     std::optional<ValueRange> range = {});

// --- adaptive palettes ------------------------------------------------------------------------

struct PaletteOptions {
    int colors = 256;     // entries, 2 .. 256
    int refinements = 4;  // rounds of k-means after the median cut, 0 .. 64
    bool dither = false;  // Floyd-Steinberg
    int threads = 0;      // 0: what the process may use; the result is the same for every number
};
// A palette made for a kRgba8 picture, and the picture in it. A picture of at most `colors` colours comes out
// exact. Else: median cut (Heckbert 1982) by the variance of the boxes, then k-means (Lloyd). Distances are of
// display codes, premultiplied by alpha, with alpha as a fourth coordinate. Pixels of alpha 0 count as one colour
// and have an entry of their own, the first. Without dithering every pixel takes its nearest entry, the lower of two.
// Dithering hands the error of an opaque pixel on in linear light, row by row to and fro, so that an area keeps the
// mean of its light as far as entries can mix it. Exact in integers.
TESSERA_API IndexedImage make_palette(const Image& image, const PaletteOptions& options = {});

}  // namespace tessera
