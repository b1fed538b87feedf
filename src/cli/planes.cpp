#include "cli/planes.h"

#include <tessera/error.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tessera::cli {
namespace {

std::size_t pixels_of(const Image& plane) {
    return static_cast<std::size_t>(plane.width()) * static_cast<std::size_t>(plane.height());
}

// 0 .. 1 in 16 bits.
std::uint16_t code16(float value) {
    return static_cast<std::uint16_t>(std::clamp(value, 0.0f, 1.0f) * 65535.0f + 0.5f);
}

// A picture of 16 bits a channel; pixel(i, out) writes red, green and blue.
template <class Pixel>
Image picture16(const Image& plane, Pixel&& pixel) {
    Image picture(plane.width(), plane.height(), PixelFormat::kRgba16);
    auto* out = picture.data<std::uint16_t>();
    for (std::size_t i = 0, n = pixels_of(plane); i < n; ++i, out += 4) {
        pixel(i, out);
        out[3] = 65535;
    }
    return picture;
}

// -1 .. 1 as 0 .. 65535; black where nothing was hit.
Image picture_of_normals(const Image& plane) {
    const float* n = plane.data<float>();
    return picture16(plane, [n](std::size_t i, std::uint16_t* out) {
        const float* v = n + 3 * i;
        const bool hit = v[0] != 0 || v[1] != 0 || v[2] != 0;
        for (int c = 0; c < 3; ++c) out[c] = hit ? code16(0.5f * v[c] + 0.5f) : std::uint16_t{0};
    });
}

// The part of texture coordinates that repeats.
Image picture_of_uv(const Image& plane) {
    const float* uv = plane.data<float>();
    return picture16(plane, [uv](std::size_t i, std::uint16_t* out) {
        for (int c = 0; c < 2; ++c)
            out[c] =
                code16(uv[2 * i + static_cast<std::size_t>(c)] - std::floor(uv[2 * i + static_cast<std::size_t>(c)]));
        out[2] = 0;
    });
}

std::vector<std::byte> encode_alpha(const Image& plane, const PngOptions& png) {
    Image codes(plane.width(), plane.height(), PixelFormat::kU32);
    for (std::size_t i = 0, n = pixels_of(plane); i < n; ++i)
        codes.data<std::uint32_t>()[i] = code16(plane.data<float>()[i]);
    return encode_grey_png(codes, png);
}

std::vector<std::byte> encode_as_png(Aov aov, const PlaneOptions& options, const Image& plane) {
    const PngOptions& png = options.encode.png;
    switch (aov) {
        case Aov::kColor:
            return options.palette ? encode_png(make_palette(plane, *options.palette), png) : encode_png(plane, png);
        case Aov::kAlpha:
            return encode_alpha(plane, png);
        case Aov::kDepth:
            return encode_depth_png(plane, options.depth_scale, png);
        case Aov::kNormal:
        case Aov::kShadingNormal:
            return encode_png(picture_of_normals(plane), png);
        case Aov::kUv:
            return encode_png(picture_of_uv(plane), png);
        case Aov::kAlbedo:
            return encode_png(display_picture(plane), png);
        case Aov::kMotionSeen:
            return encode_grey_png(plane, png);
        case Aov::kNode:
        case Aov::kMaterial:
        case Aov::kPrimitive:
            return encode_id_png(plane, png);
        case Aov::kPosition:
        case Aov::kMotion:
            break;
    }
    throw Error(ErrorCode::kUsage, std::string(name(aov)) + " cannot be written as PNG");
}

struct ChannelName {
    const char* name;
    ChannelType type;
};
std::vector<ChannelName> channels_of(Aov aov) {
    constexpr ChannelType kFloat = ChannelType::kFloat, kUint = ChannelType::kUint;
    switch (aov) {
        case Aov::kColor:
            return {{"R", ChannelType::kHalf},
                    {"G", ChannelType::kHalf},
                    {"B", ChannelType::kHalf},
                    {"A", ChannelType::kHalf}};
        case Aov::kAlpha:
            return {{"alpha.A", kFloat}};
        case Aov::kDepth:
            return {{"depth.Z", kFloat}};
        case Aov::kNormal:
            return {{"normal.X", kFloat}, {"normal.Y", kFloat}, {"normal.Z", kFloat}};
        case Aov::kShadingNormal:
            return {{"shading-normal.X", kFloat}, {"shading-normal.Y", kFloat}, {"shading-normal.Z", kFloat}};
        case Aov::kUv:
            return {{"uv.U", kFloat}, {"uv.V", kFloat}};
        case Aov::kPosition:
            return {{"position.X", kFloat}, {"position.Y", kFloat}, {"position.Z", kFloat}};
        case Aov::kAlbedo:
            return {{"albedo.R", kFloat}, {"albedo.G", kFloat}, {"albedo.B", kFloat}};
        case Aov::kNode:
            return {{"node.ID", kUint}};
        case Aov::kMaterial:
            return {{"material.ID", kUint}};
        case Aov::kPrimitive:
            return {{"primitive.ID", kUint}};
        case Aov::kMotion:
            return {{"forward.X", kFloat}, {"forward.Y", kFloat}, {"backward.X", kFloat}, {"backward.Y", kFloat}};
        case Aov::kMotionSeen:
            return {{"motion.seen", kUint}};
    }
    return {};
}

std::vector<std::byte> encode_as_exr(const PlaneFile& file, const RenderResult& result) {
    std::vector<ImageChannel> channels;
    int width = 0, height = 0;
    for (const Aov aov : file.planes) {
        const Image& plane = aov == Aov::kColor ? result.linear : plane_of(aov, result);
        const std::vector<ChannelName> names = channels_of(aov);
        for (std::size_t c = 0; c < names.size(); ++c)
            channels.push_back({names[c].name, names[c].type, plane.bytes().data() + 4 * c, 4 * names.size()});
        width = plane.width(), height = plane.height();
    }
    return encode_exr(width, height, channels);
}

}  // namespace

const Image& plane_of(Aov aov, const RenderResult& result) {
    switch (aov) {
        case Aov::kColor:
            break;
        case Aov::kAlpha:
            return result.alpha;
        case Aov::kDepth:
            return result.depth;
        case Aov::kNormal:
            return result.normal;
        case Aov::kShadingNormal:
            return result.shading_normal;
        case Aov::kUv:
            return result.uv;
        case Aov::kPosition:
            return result.position;
        case Aov::kAlbedo:
            return result.albedo;
        case Aov::kNode:
            return result.node;
        case Aov::kMaterial:
            return result.material;
        case Aov::kPrimitive:
            return result.primitive;
        case Aov::kMotion:
            return result.motion;
        case Aov::kMotionSeen:
            return result.motion_seen;
    }
    return result.color.empty() ? result.linear : result.color;
}

void finish_color(const PlaneOptions& options, RenderResult& result) {
    if (result.color.empty()) return;
    if (options.color_bits) {
        const auto [red, green, blue] = *options.color_bits;
        result.color = quantize_true_color(result.color, red, green, blue);
    }
    if (options.palette) result.color = to_rgba8(make_palette(result.color, *options.palette));
    result.stats.color_hash = hash_pixels(result.color);
}

std::vector<std::byte> encode_planes(const PlaneOptions& options, const PlaneFile& file, const RenderResult& result) {
    if (options.extension == "exr") return encode_as_exr(file, result);
    const Aov aov = file.planes.front();
    const Image& plane = plane_of(aov, result);
    if (options.extension == "npy") return encode_npy(plane);
    if (options.colormap && is_number_plane(aov)) {
        if (options.extension == "png" && *options.colormap != Colormap::kIds)
            return encode_png(index_plane(plane, *options.colormap, 8, options.range), options.encode.png);
        return encode_image(options.extension, apply_colormap(plane, *options.colormap, options.range), options.encode);
    }
    if (options.extension == "png") return encode_as_png(aov, options, plane);
    return encode_image(options.extension, plane, options.encode);
}

}  // namespace tessera::cli
