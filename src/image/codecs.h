// The codecs behind decode_image() and write_image(), one pair of functions per format. They take
// and give whole files in memory. Values are as stored: gamma, ICC profiles and orientation are
// ignored, as glTF demands, but alpha is made straight where 8 or 16 bits are premultiplied. All throw tessera::Error
// without a file name; the caller adds it.
#pragma once

#include <tessera/image.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

class Arena;

bool is_png(std::span<const std::byte> file);
ImageInfo read_png_info(std::span<const std::byte> file);
Image decode_png(std::span<const std::byte> file, std::uint64_t max_pixels, bool keep_16_bit);
// As the public encode_png(), on the threads of `arena`: the bytes do not depend on their number.
std::vector<std::byte> encode_png(const Image& image, const PngOptions& options, Arena& arena);

bool is_jpeg(std::span<const std::byte> file);
ImageInfo read_jpeg_info(std::span<const std::byte> file);
Image decode_jpeg(std::span<const std::byte> file, std::uint64_t max_pixels);

bool is_hdr(std::span<const std::byte> file);
ImageInfo read_hdr_info(std::span<const std::byte> file);
Image decode_hdr(std::span<const std::byte> file, std::uint64_t max_pixels);

bool is_webp(std::span<const std::byte> file);
ImageInfo read_webp_info(std::span<const std::byte> file);
Image decode_webp(std::span<const std::byte> file, std::uint64_t max_pixels);

// Their headers are read and checked here; the rest needs the OpenImageIO module (module.h).
bool is_exr(std::span<const std::byte> file);
ImageInfo read_exr_info(std::span<const std::byte> file);
Image decode_exr(std::span<const std::byte> file, std::uint64_t max_pixels);

bool is_tiff(std::span<const std::byte> file);
ImageInfo read_tiff_info(std::span<const std::byte> file);
Image decode_tiff(std::span<const std::byte> file, std::uint64_t max_pixels, bool keep_16_bit);

// Throws kLimit when a picture is larger than `max_pixels` or than an Image can be. Called with the
// sides that a header claims, before anything is allocated for them.
void check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_pixels);

// Writes `bytes` to `path` so that no half-written file is ever seen there: to a temporary file
// beside it, then renamed. Devices, pipes and the like are written directly. Throws kOutput, naming
// the file; the temporary file is then gone and an old file at `path` is untouched.
void write_file(const std::string& path, std::span<const std::byte> bytes);

}  // namespace tessera
