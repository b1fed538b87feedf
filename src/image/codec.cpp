// Choosing a codec: by content when reading, by extension when writing.
#include "image/codecs.h"
#include "image/foreign_formats.h"

#include <tessera/error.h>
#include <tessera/image_files.h>
#include <tessera/planes.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace tessera {
namespace {

// A picture file larger than this is refused before it is read.
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 31;

// A format that is told by its first bytes.
struct Reading {
    bool (*is)(std::span<const std::byte> file);
    ImageInfo (*info)(std::span<const std::byte> file);
    Image (*decode)(std::span<const std::byte> file, const DecodeOptions& options);
};

constexpr Reading kReadings[] = {
    {is_png, read_png_info, [](auto file, auto& o) { return decode_png(file, o.max_pixels, o.keep_16_bit); }},
    {is_jpeg, read_jpeg_info, [](auto file, auto& o) { return decode_jpeg(file, o.max_pixels); }},
    {is_hdr, read_hdr_info, [](auto file, auto& o) { return decode_hdr(file, o.max_pixels); }},
    {is_exr, read_exr_info, [](auto file, auto& o) { return decode_exr(file, o.max_pixels); }},
    {is_tiff, read_tiff_info, [](auto file, auto& o) { return decode_tiff(file, o.max_pixels, o.keep_16_bit); }},
    {is_webp, read_webp_info, [](auto file, auto& o) { return decode_webp(file, o.max_pixels); }},
};

const Reading& reading_of(std::span<const std::byte> file) {
    for (const Reading& reading : kReadings)
        if (reading.is(file)) return reading;
    constexpr const char* kRead = "PNG, JPEG, HDR, EXR, TIFF or WebP";
    if (const std::string_view format = foreign_picture_format(file); !format.empty())
        throw Error(ErrorCode::kInput,
                    "a picture in " + std::string(format) + ", which is not read (" + kRead + " are)");
    throw Error(ErrorCode::kInput, std::string("not a picture that can be read (") + kRead + ")");
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

// decode() of the file's bytes, whose errors then name the file.
template <class Decode>
auto read_and(const std::string& path, const Decode& decode) {
    const std::vector<std::byte> file = read_file(path);
    try {
        return decode(std::span<const std::byte>(file));
    } catch (const Error& e) {
        throw Error(e.code(), e.message(), path, e.location());
    }
}

std::vector<std::byte> encode_linear_exr(const Image& image, const EncodeOptions& options) {
    if (image.empty() || image.format() != PixelFormat::kRgba32f)
        throw Error(ErrorCode::kUsage, "EXR takes images of linear floating-point RGBA");
    if (options.exr_type == ChannelType::kUint) throw Error(ErrorCode::kUsage, "RGBA in EXR is half or float");
    const float* pixels = image.data<float>();
    const ChannelType type = options.exr_type;
    const ImageChannel channels[] = {
        {"R", type, pixels, 16}, {"G", type, pixels + 1, 16}, {"B", type, pixels + 2, 16}, {"A", type, pixels + 3, 16}};
    return encode_exr(image.width(), image.height(), channels);
}

struct Writing {
    std::string_view extension;
    FileContent content;
    std::vector<std::byte> (*encode)(const Image& image, const EncodeOptions& options);
};

constexpr auto kWriteJpeg = [](const Image& image, const EncodeOptions& o) {
    return encode_jpeg(image, o.jpeg_quality);
};
constexpr auto kWriteTiff = [](const Image& image, const EncodeOptions&) { return encode_tiff(image); };
constexpr Writing kWritings[] = {
    {"png", FileContent::kDisplay, [](const Image& image, const EncodeOptions& o) { return encode_png(image, o.png); }},
    {"jpg", FileContent::kDisplay, kWriteJpeg},
    {"jpeg", FileContent::kDisplay, kWriteJpeg},
    {"tif", FileContent::kDisplay, kWriteTiff},
    {"tiff", FileContent::kDisplay, kWriteTiff},
    {"webp", FileContent::kDisplay,
     [](const Image& image, const EncodeOptions& o) { return encode_webp(image, o.webp); }},
    {"exr", FileContent::kLinear, encode_linear_exr},
    {"hdr", FileContent::kLinear, [](const Image& image, const EncodeOptions&) { return encode_hdr(image); }},
};

const Writing* writing_of(std::string extension) {
    if (extension.starts_with('.')) extension.erase(0, 1);
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (const Writing& writing : kWritings)
        if (writing.extension == extension) return &writing;
    return nullptr;
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

ImageInfo read_image_info(std::span<const std::byte> file) { return reading_of(file).info(file); }

Image decode_image(std::span<const std::byte> file, const DecodeOptions& options) {
    const Reading& reading = reading_of(file);
    if (!options.keep_float && reading.info(file).floating)
        throw Error(ErrorCode::kInput, "the picture has floating-point values; here only 8 or 16 bits can be used");
    return reading.decode(file, options);
}

Image decode_image(std::span<const std::byte> file, std::uint64_t max_pixels, bool keep_16_bit) {
    return decode_image(file, DecodeOptions{max_pixels, keep_16_bit});
}

Image read_image(const std::string& path, const DecodeOptions& options) {
    return read_and(path, [&](std::span<const std::byte> file) { return decode_image(file, options); });
}

std::vector<ImagePlane> read_exr_channels(const std::string& path, std::uint64_t max_pixels) {
    return read_and(path, [&](std::span<const std::byte> file) {
        return is_exr(file) ? decode_exr_channels(file, max_pixels) : std::vector<ImagePlane>();
    });
}

Image read_image(const std::string& path, std::uint64_t max_pixels, bool keep_16_bit) {
    return read_image(path, DecodeOptions{max_pixels, keep_16_bit});
}

FileContent file_content(const std::string& extension) {
    const Writing* writing = writing_of(extension);
    return writing != nullptr ? writing->content : FileContent::kUnknown;
}

std::vector<std::byte> encode_image(const std::string& extension, const Image& image, const EncodeOptions& options) {
    if (const Writing* writing = writing_of(extension)) return writing->encode(image, options);
    std::string known;
    for (const Writing& writing : kWritings) known.append(known.empty() ? "." : ", .").append(writing.extension);
    throw Error(ErrorCode::kOutput, "the extension must be one of " + known);
}

void write_image(const std::string& path, const Image& image) {
    std::vector<std::byte> file;
    try {
        file = encode_image(std::filesystem::path(path).extension().string(), image);
    } catch (const Error& e) {
        throw Error(e.code(), e.message(), path);
    }
    write_file(path, file);
}

}  // namespace tessera
