// Decodes the input as a picture. Whatever decodes must also survive being written and read again;
// everything else must end in tessera::Error. Of EXR and TIFF only the headers, which the library reads
// itself: the OpenImageIO module is not instrumented.
#include <tessera/error.h>
#include <tessera/image_files.h>

#include <algorithm>
#include <cstdlib>

namespace {

bool same_pixels(const tessera::Image& a, const tessera::Image& b) {
    return std::equal(a.bytes().begin(), a.bytes().end(), b.bytes().begin(), b.bytes().end());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto file = std::as_bytes(std::span(data, size));
    constexpr std::uint64_t kMaxPixels = 1u << 18;
    try {
        const tessera::ImageInfo info = tessera::read_image_info(file);
        if (info.codec == "exr" || info.codec == "tiff") return 0;
        const tessera::Image image = tessera::decode_image(file, {kMaxPixels, size % 2 == 1, true});
        if (info.width != image.width() || info.height != image.height()) std::abort();
        if (image.bytes().size() > 1u << 16) return 0;
        const tessera::DecodeOptions all{kMaxPixels, true, true};
        if (info.floating) {
            // Radiance files need not be normalised; what is written is.
            const tessera::Image once = tessera::decode_image(tessera::encode_hdr(image), all);
            if (!same_pixels(once, tessera::decode_image(tessera::encode_hdr(once), all))) std::abort();
        } else if (!same_pixels(image, tessera::decode_image(tessera::encode_png(image), all))) {
            std::abort();
        }
    } catch (const tessera::Error&) {
        // A refusal is a good answer.
    }
    return 0;
}
