// Pictures and label planes. An Image owns one plane of `width` x `height` pixels, row by row from
// the top left, without padding. Formats: rgba8 (display colour, sRGB-encoded, straight alpha),
// rgba32f (linear Rec. 709, straight alpha unless a producer says otherwise); of labels, f32, u32, and two or
// three f32.
// Reading and writing throw tessera::Error; nothing here is global, so any thread may call.
#pragma once

#include <tessera/export.h>
#include <tessera/shading_model.h>
#include <tessera/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tessera {

enum class PixelFormat { kRgba8, kRgba16, kRgba32f, kF32, kU32, kRg32f, kRgb32f };

// Bytes of one pixel: 4, 8, 16, 4, 4, 8, 12.
TESSERA_API std::size_t bytes_per_pixel(PixelFormat format);

TESSERA_API void* allocate_pixels(std::size_t bytes);
TESSERA_API void free_pixels(void* pixels);

// The largest width or height, in pixels.
inline constexpr int kMaxImageSide = 16384;

// Memory of pixels starts on a cache line, and lies on large pages where the system has them.
template <class T>
struct PixelAllocator {
    using value_type = T;

    PixelAllocator() = default;
    template <class U>
    PixelAllocator(const PixelAllocator<U>&) {}
    T* allocate(std::size_t count) { return static_cast<T*>(allocate_pixels(count * sizeof(T))); }
    void deallocate(T* pixels, std::size_t) { free_pixels(pixels); }
    friend bool operator==(PixelAllocator, PixelAllocator) { return true; }
};

class TESSERA_API Image {
  public:
    Image() = default;
    // Zero-filled. Throws kLimit for sides outside 1 .. kMaxImageSide.
    Image(int width, int height, PixelFormat format);

    int width() const { return width_; }
    int height() const { return height_; }
    PixelFormat format() const { return format_; }
    bool empty() const { return data_.empty(); }
    std::size_t row_bytes() const { return static_cast<std::size_t>(width_) * bytes_per_pixel(format_); }

    std::span<std::byte> bytes() { return data_; }
    std::span<const std::byte> bytes() const { return data_; }
    // The pixels as T: uint8_t or uint16_t channels, float channels, or uint32_t values.
    template <class T>
    T* data() {
        return reinterpret_cast<T*>(data_.data());
    }
    template <class T>
    const T* data() const {
        return reinterpret_cast<const T*>(data_.data());
    }

  private:
    int width_ = 0, height_ = 0;
    PixelFormat format_ = PixelFormat::kRgba8;
    std::vector<std::byte, PixelAllocator<std::byte>> data_;
};

// --- codecs ---------------------------------------------------------------------------------

struct ImageInfo {
    int width = 0, height = 0, channels = 0, bits = 8;
    std::string codec;           // "png", "jpeg", "hdr", "exr", "tiff" or "webp"
    bool floating = false;       // the samples are floating-point numbers: linear light
    bool premultiplied = false;  // colour is stored multiplied by alpha
};

// Reads the header only; no format needs the OpenImageIO module for that. The codec is told by content.
// Throws kInput when it is none we know.
TESSERA_API ImageInfo read_image_info(std::span<const std::byte> file);

struct DecodeOptions {
    std::uint64_t max_pixels = 1u << 28;
    bool keep_16_bit = false;  // 16-bit PNG and TIFF become kRgba16; otherwise they are rounded to kRgba8
    bool keep_float = false;   // HDR, EXR and floating-point TIFF become kRgba32f; otherwise they are refused
};
// Decodes PNG (8 and 16 bit, every colour type), JPEG (8 bit grey, YCbCr, CMYK), WebP (not animated),
// Radiance HDR and, with the OpenImageIO module, OpenEXR (one part; the channels R, G, B, A or Y) and
// TIFF (8, 16, 32-bit float; the first page). Values are as stored, no colour space is applied; alpha is
// straight in kRgba8 and kRgba16, and as stored in kRgba32f (see ImageInfo::premultiplied).
// Throws kInput for a damaged file and where the module is missing, and kLimit when width * height
// exceeds `max_pixels`, before the pixels are allocated.
TESSERA_API Image decode_image(std::span<const std::byte> file, const DecodeOptions& options);
TESSERA_API Image decode_image(std::span<const std::byte> file, std::uint64_t max_pixels = 1u << 28,
                               bool keep_16_bit = false);
// Reads and decodes a file; the error names it.
TESSERA_API Image read_image(const std::string& path, const DecodeOptions& options);
TESSERA_API Image read_image(const std::string& path, std::uint64_t max_pixels = 1u << 28, bool keep_16_bit = false);

struct PngOptions {
    int level = 1;                  // 0 (stored) .. 12 (smallest)
    bool drop_opaque_alpha = true;  // write RGB when every alpha is full
    int threads = 0;                // 0: what the process may use; the bytes are the same
};
// kRgba8 becomes 8-bit, kRgba16 16-bit RGB(A); kF32 and kU32 are refused (kUsage).
TESSERA_API std::vector<std::byte> encode_png(const Image& image, const PngOptions& options = {});
// kRgba8 only; alpha is dropped; quality 1 .. 100, 4:4:4 from 90 on, 4:2:0 below.
TESSERA_API std::vector<std::byte> encode_jpeg(const Image& image, int quality = 92);
// Chooses the codec by the extension, as encode_image() of image_files.h does, which has the codecs
// beyond these two. Writes a temporary file beside `path` and renames it, so that a failure leaves nothing behind.
// Throws kOutput.
TESSERA_API void write_image(const std::string& path, const Image& image);

// Linear Rec. 709 (kRgb32f) as an opaque kRgba8 picture: each channel the nearest sRGB code.
TESSERA_API Image display_picture(const Image& linear);

// N-plane true colour (FB1): every kRgba8 channel reduced to its number of bits (1 .. 8 each, such as
// 3-3-2 or 5-6-5, which gives 2^N colours) and widened again, rounding to the nearest level.
TESSERA_API Image quantize_true_color(const Image& image, int red_bits, int green_bits, int blue_bits);

// --- comparison -----------------------------------------------------------------------------

struct ImageDifference {
    std::uint64_t differing_pixels = 0;
    double max_error = 0, mean_error = 0;  // over all channels, in units of 1/255 for kRgba8
    double psnr = 0;                       // dB, of a signal of 1 for floats; infinity for equal images
};
// Both images must have the same size and format (kUsage otherwise). A pixel differs when a channel
// differs by more than `tolerance` (in 1/255 for kRgba8, 1/65535 for kRgba16).
TESSERA_API ImageDifference compare_images(const Image& a, const Image& b, double tolerance = 0);
// A picture of where two images of kRgba8 or kRgba32f (`tolerance` in its own unit) differ: the first
// one greyed, differences in red.
TESSERA_API Image difference_picture(const Image& a, const Image& b, double tolerance = 0);
// FNV-1a (64 bit) over the pixel bytes: the `color_hash` of the statistics.
TESSERA_API std::uint64_t hash_pixels(const Image& image);

}  // namespace tessera
