#include "cli/picture_file.h"

namespace tessera::cli {

void finish_color(const RenderJob& job, RenderResult& result) {
    if (job.color_bits) {
        const auto [red, green, blue] = *job.color_bits;
        result.color = quantize_true_color(result.color, red, green, blue);
    }
    result.stats.color_hash = hash_pixels(result.color);
}

std::vector<std::byte> encode_color(const RenderJob& job, const RenderResult& result) {
    if (job.codec == Codec::kJpeg) return encode_jpeg(result.color, job.quality);
    PngOptions png;
    png.level = job.png_level;
    png.threads = job.render.threads;
    return encode_png(result.color, png);
}

}  // namespace tessera::cli
