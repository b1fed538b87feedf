#include "render/stage_picture.h"

#include "image/false_color.h"

#include <algorithm>

namespace tessera {
namespace {

template <class T>
void paint(const Image& stage, int lines, Image& color) {
    const FalseColors colors = false_colors();
    const T* const values = stage.data<T>();
    const auto pixels = static_cast<std::size_t>(stage.width()) * static_cast<std::size_t>(stage.height());
    const double most = static_cast<double>(*std::max_element(values, values + pixels));
    std::uint8_t* out = color.data<std::uint8_t>();
    const T* value = values;
    for (int y = 0; y < stage.height(); ++y)
        for (int x = 0; x < stage.width(); ++x, ++value, out += 4) {
            const double fraction = most > 0 ? static_cast<double>(*value) / most : 0.0;
            const auto& rgb = colors[static_cast<std::size_t>(fraction * 255 + 0.5)];
            const bool line = lines != 0 && ((x != 0 && x % lines == 0) || (y != 0 && y % lines == 0));
            for (int c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(line ? rgb[c] / 2 : rgb[c]);
            out[3] = 255;
        }
}

}  // namespace

RasterInspection make_stage_plane(const RenderOptions& options, RenderResult& result) {
    RasterInspection inspection;
    Image& plane = result.stage;
    if (options.show == Stage::kPicture) {
        plane = {};
        return inspection;
    }
    const PixelFormat format = options.show == Stage::kHiZ ? PixelFormat::kF32 : PixelFormat::kU32;
    if (plane.width() != options.width || plane.height() != options.height || plane.format() != format)
        plane = Image(options.width, options.height, format);
    switch (options.show) {
        case Stage::kPicture:
            break;
        case Stage::kBins:
            inspection.bins = plane.data<std::uint32_t>();
            break;
        case Stage::kHiZ:
            inspection.floor = plane.data<float>();
            break;
        case Stage::kOverdraw:
            inspection.overdraw = plane.data<std::uint32_t>();
            break;
        case Stage::kCost:
            inspection.cost = plane.data<std::uint32_t>();
            break;
    }
    return inspection;
}

void paint_stage(Stage stage, int tile_side, RenderResult& result) {
    if (stage == Stage::kHiZ)
        paint<float>(result.stage, 0, result.color);
    else
        paint<std::uint32_t>(result.stage, stage == Stage::kOverdraw ? 0 : tile_side, result.color);
}

}  // namespace tessera
