// Writing Radiance pictures, run-length encoded channel by channel where the format has that (scan lines
// of 8 to 32767 pixels).
#include "image/codecs.h"
#include "image/rgbe.h"

#include "core/fp_environment.h"

#include <tessera/error.h>
#include <tessera/image_files.h>

#include <string>

namespace tessera {
namespace {

// The number of bytes from `at` on that are the same, at most 127.
std::size_t run_length(const std::vector<std::uint8_t>& bytes, std::size_t at) {
    constexpr std::size_t kLongest = 127;
    std::size_t length = 1;
    while (length < kLongest && at + length < bytes.size() && bytes[at + length] == bytes[at]) ++length;
    return length;
}

// Runs of three and more as a count beyond 128 and the byte, what lies between as a count and the bytes.
void append_channel(const std::vector<std::uint8_t>& bytes, std::vector<std::byte>& out) {
    constexpr std::size_t kLeastRun = 3, kMostPlain = 128;
    for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t run = run_length(bytes, at);
        if (run >= kLeastRun) {
            out.push_back(static_cast<std::byte>(128 + run));
            out.push_back(static_cast<std::byte>(bytes[at]));
            at += run;
            continue;
        }
        std::size_t end = at;
        while (end < bytes.size() && end - at < kMostPlain && run_length(bytes, end) < kLeastRun) ++end;
        out.push_back(static_cast<std::byte>(end - at));
        for (; at < end; ++at) out.push_back(static_cast<std::byte>(bytes[at]));
    }
}

}  // namespace

std::vector<std::byte> encode_hdr(const Image& image) {
    if (image.empty() || image.format() != PixelFormat::kRgba32f)
        throw Error(ErrorCode::kUsage, "HDR takes images of linear floating-point RGBA");
    const FpEnvironment environment;
    const auto width = static_cast<std::size_t>(image.width());
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height()) + " +X " +
                               std::to_string(width) + "\n";
    const auto* text = reinterpret_cast<const std::byte*>(header.data());
    std::vector<std::byte> file(text, text + header.size());
    constexpr std::size_t kLeastWidth = 8, kMostWidth = 0x7fff;
    const bool runs = width >= kLeastWidth && width <= kMostWidth;
    std::vector<std::uint8_t> line(4 * width), channel(width);
    const auto* pixel = image.data<float>();
    for (int y = 0; y < image.height(); ++y) {
        for (std::size_t x = 0; x < width; ++x, pixel += 4) float_to_rgbe(pixel, &line[4 * x]);
        if (!runs) {
            for (const std::uint8_t byte : line) file.push_back(static_cast<std::byte>(byte));
            continue;
        }
        for (const std::size_t byte : {std::size_t{2}, std::size_t{2}, width >> 8, width & 0xff})
            file.push_back(static_cast<std::byte>(byte));
        for (std::size_t c = 0; c < 4; ++c) {
            for (std::size_t x = 0; x < width; ++x) channel[x] = line[4 * x + c];
            append_channel(channel, file);
        }
    }
    return file;
}

}  // namespace tessera
