// Writing WebP through libwebp: lossless by default, down to the colours of transparent pixels.
#include "image/codecs.h"

#include <tessera/error.h>
#include <tessera/image_files.h>

#include <webp/encode.h>

namespace tessera {
namespace {

// libwebp's structures with their owner.
struct Writer {
    WebPConfig config;
    WebPPicture picture;
    WebPMemoryWriter file;

    Writer() {
        if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0)
            throw Error(ErrorCode::kInternal, "libwebp has another version");
        WebPMemoryWriterInit(&file);
        picture.writer = WebPMemoryWrite;
        picture.custom_ptr = &file;
    }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer() {
        WebPPictureFree(&picture);
        WebPMemoryWriterClear(&file);
    }
};

}  // namespace

std::vector<std::byte> encode_webp(const Image& image, const WebpOptions& options) {
    if (image.empty() || image.format() != PixelFormat::kRgba8)
        throw Error(ErrorCode::kUsage, "WebP takes 8-bit RGBA images");
    if (image.width() > WEBP_MAX_DIMENSION || image.height() > WEBP_MAX_DIMENSION)
        throw Error(ErrorCode::kUsage, "WebP takes at most " + std::to_string(WEBP_MAX_DIMENSION) + " pixels a side");
    if (!options.lossless && (options.quality < 1 || options.quality > 100))
        throw Error(ErrorCode::kUsage, "the WebP quality must be 1 to 100");

    Writer writer;
    if (options.lossless) {
        constexpr int kEffort = 4;  // 0 .. 9
        WebPConfigLosslessPreset(&writer.config, kEffort);
        writer.config.exact = 1;
        writer.picture.use_argb = 1;
    } else {
        writer.config.quality = static_cast<float>(options.quality);
    }
    writer.picture.width = image.width();
    writer.picture.height = image.height();
    // Whether there is alpha to be written, the library finds out itself.
    const bool written =
        WebPPictureImportRGBA(&writer.picture, image.data<std::uint8_t>(), static_cast<int>(image.row_bytes())) != 0 &&
        WebPEncode(&writer.config, &writer.picture) != 0;
    if (!written)
        throw Error(ErrorCode::kLimit,
                    "not enough memory to write a WebP, or the picture is more than the format takes");
    const auto* bytes = reinterpret_cast<const std::byte*>(writer.file.mem);
    return {bytes, bytes + writer.file.size};
}

}  // namespace tessera
