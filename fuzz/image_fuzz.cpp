// Decodes the input as a picture. Whatever decodes must also survive being written and read again;
// everything else must end in tessera::Error.
#include <tessera/error.h>
#include <tessera/image.h>

#include <algorithm>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto file = std::as_bytes(std::span(data, size));
    constexpr std::uint64_t kMaxPixels = 1u << 18;
    try {
        const bool keep_16_bit = size % 2 == 1;
        const tessera::Image image = tessera::decode_image(file, kMaxPixels, keep_16_bit);
        const tessera::ImageInfo info = tessera::read_image_info(file);
        if (info.width != image.width() || info.height != image.height()) std::abort();
        if (image.bytes().size() > 1u << 16) return 0;
        const tessera::Image again = tessera::decode_image(tessera::encode_png(image), kMaxPixels, true);
        if (!std::equal(image.bytes().begin(), image.bytes().end(), again.bytes().begin(), again.bytes().end()))
            std::abort();
    } catch (const tessera::Error&) {
        // A refusal is a good answer.
    }
    return 0;
}
