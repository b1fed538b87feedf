// Choosing a codec: by content when reading, by extension when writing.
#include "image/codecs.h"

#include <tessera/error.h>
#include <tessera/image.h>
#include <tessera/planes.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace tessera {
namespace {

// A picture file larger than this is refused before it is read.
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 31;

[[noreturn]] void throw_unknown_format() {
    throw Error(ErrorCode::kInput, "not a picture that can be read (PNG or JPEG)");
}

std::vector<std::byte> read_file(const std::string& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) throw Error(ErrorCode::kInput, "is a folder, not a picture", path);
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error(ErrorCode::kInput, std::string("cannot open: ") + std::strerror(errno), path);
    std::vector<std::byte> bytes;
    // In pieces, not by the size that the file system tells: pipes tell none.
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    while (in) {
        const std::size_t old = bytes.size();
        if (old > kMaxFileBytes) throw Error(ErrorCode::kLimit, "picture file larger than 2 GiB", path);
        bytes.resize(old + kPiece);
        in.read(reinterpret_cast<char*>(bytes.data() + old), kPiece);
        bytes.resize(old + static_cast<std::size_t>(in.gcount()));
    }
    if (in.bad()) throw Error(ErrorCode::kInput, "cannot read", path);
    return bytes;
}

std::string lower_case_extension(const std::string& path) {
    std::string e = std::filesystem::path(path).extension().string();
    for (char& c : e)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return e;
}

}  // namespace

NpyArray read_npy(const std::string& path, std::uint64_t max_pixels) {
    const std::vector<std::byte> file = read_file(path);
    try {
        return decode_npy(file, max_pixels);
    } catch (const Error& e) {
        throw Error(e.code(), e.message(), path, e.location());
    }
}

void check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_pixels) {
    const std::string claim = "a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels";
    if (width == 0 || height == 0) throw Error(ErrorCode::kInput, claim);
    // Both sides have at most 32 bits, so the product cannot wrap.
    if (width * height > max_pixels)
        throw Error(ErrorCode::kLimit, claim + " exceeds the limit of " + std::to_string(max_pixels) + " pixels");
    if (width > kMaxImageSide || height > kMaxImageSide)
        throw Error(ErrorCode::kLimit, claim + " exceeds " + std::to_string(kMaxImageSide) + " pixels a side");
}

ImageInfo read_image_info(std::span<const std::byte> file) {
    if (is_png(file)) return read_png_info(file);
    if (is_jpeg(file)) return read_jpeg_info(file);
    throw_unknown_format();
}

Image decode_image(std::span<const std::byte> file, std::uint64_t max_pixels, bool keep_16_bit) {
    if (is_png(file)) return decode_png(file, max_pixels, keep_16_bit);
    if (is_jpeg(file)) return decode_jpeg(file, max_pixels);
    throw_unknown_format();
}

Image read_image(const std::string& path, std::uint64_t max_pixels, bool keep_16_bit) {
    const std::vector<std::byte> file = read_file(path);
    try {
        return decode_image(file, max_pixels, keep_16_bit);
    } catch (const Error& e) {
        throw Error(e.code(), e.message(), path, e.location());
    }
}

void write_image(const std::string& path, const Image& image) {
    const std::string extension = lower_case_extension(path);
    if (extension == ".png")
        write_file(path, encode_png(image));
    else if (extension == ".jpg" || extension == ".jpeg")
        write_file(path, encode_jpeg(image));
    else
        throw Error(ErrorCode::kOutput, "the extension must be .png, .jpg or .jpeg", path);
}

}  // namespace tessera
