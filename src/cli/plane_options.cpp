// What --aov and its like mean, and which files can hold it.
#include "cli/parse.h"
#include "cli/pattern.h"
#include "cli/planes.h"

#include <algorithm>
#include <cctype>
#include <iterator>

namespace tessera::cli {
namespace {

struct AovName {
    Aov aov;
    const char* name;
};
constexpr AovName kNames[] = {
    {Aov::kColor, "color"},
    {Aov::kAlpha, "alpha"},
    {Aov::kDepth, "depth"},
    {Aov::kNormal, "normal"},
    {Aov::kUv, "uv"},
    {Aov::kPosition, "position"},
    {Aov::kAlbedo, "albedo"},
    {Aov::kNode, "node"},
    {Aov::kMaterial, "material"},
    {Aov::kPrimitive, "primitive"},
    {Aov::kMotion, "motion"},
    {Aov::kMotionSeen, "motion-seen"},
    {Aov::kShadingNormal, "shading-normal"},
};

std::vector<std::string> parts_of(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(separator, at), text.size());
        parts.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

std::vector<Aov> parse_aovs(const std::string& text) {
    std::vector<Aov> aovs;
    for (const std::string& part : parts_of(text, ',')) {
        const auto* const found =
            std::find_if(std::begin(kNames), std::end(kNames), [&](const AovName& n) { return part == n.name; });
        if (found == std::end(kNames)) {
            std::string names;
            for (const AovName& n : kNames) names.append(names.empty() ? "" : ", ").append(n.name);
            refuse("--aov", "'" + part + "' is none of " + names);
        }
        if (std::find(aovs.begin(), aovs.end(), found->aov) != aovs.end()) refuse("--aov", part + " is there twice");
        aovs.push_back(found->aov);
    }
    return aovs;
}

// Whether a file of that kind holds the plane as it is, or in the way that the help says.
void check_format(Aov aov, const PlaneOptions& options) {
    const std::string& extension = options.extension;
    if (extension == "npy" || extension == "exr") {
        if (options.colormap) refuse("--colormap", "makes pictures: it does not go with ." + extension);
        return;
    }
    const FileContent content = file_content(extension);
    if (aov == Aov::kColor && content != FileContent::kUnknown) return;
    if (options.colormap && is_number_plane(aov) && content == FileContent::kDisplay) return;
    const bool in_png = aov != Aov::kPosition && aov != Aov::kMotion;
    if (extension == "png" && in_png) return;
    refuse("--aov", std::string(name(aov)) + " cannot be written as ." + extension + "; " +
                        (in_png ? ".png, .npy and .exr can hold it" : ".npy and .exr can hold it"));
}

// A file for each plane where the names tell them apart; else one, which only EXR shares.
std::vector<PlaneFile> files_for(const std::vector<Aov>& aovs, const std::string& output,
                                 const std::string& extension) {
    std::vector<PlaneFile> files;
    if (has_place(output, "aov")) {
        for (const Aov aov : aovs) files.push_back({name(aov), {aov}});
        return files;
    }
    if (aovs.size() > 1 && extension != "exr" && !output.empty())
        refuse("--output", "several planes need {aov} in the name, or one .exr for all of them");
    files.push_back({aovs.size() == 1 ? name(aovs[0]) : "all", aovs});
    return files;
}

ValueRange parse_range(const std::string& text) {
    const std::vector<std::string> parts = parts_of(text, ',');
    if (parts.size() != 2) refuse("--range", "'" + text + "' is not LOW,HIGH");
    const ValueRange range{parse_number("--range", parts[0], -1e30, 1e30),
                           parse_number("--range", parts[1], -1e30, 1e30)};
    if (!(range.low < range.high)) refuse("--range", "must rise");
    return range;
}

}  // namespace

const char* name(Aov aov) {
    for (const AovName& n : kNames)
        if (n.aov == aov) return n.name;
    return "unknown";
}

bool is_number_plane(Aov aov) {
    return aov == Aov::kDepth || aov == Aov::kAlpha || aov == Aov::kNode || aov == Aov::kMaterial ||
           aov == Aov::kPrimitive || aov == Aov::kMotionSeen;
}

std::string extension_of(const std::string& output) {
    if (output.empty() || output == "-" || output.compare(0, 5, "/dev/") == 0) return "png";
    const std::string file = output.substr(output.find_last_of('/') + 1);
    const std::size_t dot = file.find_last_of('.');
    std::string extension = dot == std::string::npos ? std::string() : file.substr(dot + 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

PlaneOptions parse_planes(const PlaneTexts& texts, const std::string& output) {
    PlaneOptions options;
    options.extension = extension_of(output);
    const std::vector<Aov> aovs = parse_aovs(texts.aov);
    if (!texts.colormap.empty()) {
        options.colormap = colormap_named(texts.colormap);
        if (!options.colormap)
            refuse("--colormap", "'" + texts.colormap + "' is none of viridis, magma, turbo, grey, ids");
        if (std::none_of(aovs.begin(), aovs.end(), is_number_plane))
            refuse("--colormap", "needs a plane of numbers, such as --aov depth");
    }
    if (!texts.range.empty()) {
        if (!options.colormap || *options.colormap == Colormap::kIds)
            refuse("--range", "needs a --colormap of a range");
        options.range = parse_range(texts.range);
    }
    if (!texts.depth_scale.empty()) options.depth_scale = parse_number("--depth-scale", texts.depth_scale, 1e-6, 1e9);
    const auto has = [&](Aov aov) { return std::find(aovs.begin(), aovs.end(), aov) != aovs.end(); };
    const bool arrays = options.extension == "npy" || options.extension == "exr";
    if (!texts.depth_scale.empty() && (!has(Aov::kDepth) || arrays || options.colormap))
        refuse("--depth-scale", "is for --aov depth as .png, without a colormap");
    if (!texts.color_bits.empty()) {
        options.color_bits = parse_color_bits("--color-bits", texts.color_bits);
        if (file_content(options.extension) == FileContent::kLinear)
            refuse("--color-bits", "is for pictures of 8 bits");
        if (!has(Aov::kColor)) refuse("--color-bits", "needs --aov color");
    }
    if (texts.dither && texts.palette.empty()) refuse("--dither", "needs --palette");
    if (!texts.palette.empty()) {
        options.palette.emplace();
        options.palette->colors = static_cast<int>(parse_integer("--palette", texts.palette, 2, 256));
        options.palette->dither = texts.dither;
        if (options.extension != "png") refuse("--palette", "is for .png");
        if (!has(Aov::kColor)) refuse("--palette", "needs --aov color");
    }
    options.files = files_for(aovs, output, options.extension);
    for (const Aov aov : aovs) {
        if (options.colormap == Colormap::kIds && (aov == Aov::kDepth || aov == Aov::kAlpha))
            refuse("--colormap", std::string("ids is for whole numbers, not for ") + name(aov));
        if (!output.empty()) check_format(aov, options);
    }
    return options;
}

void want_planes(const PlaneOptions& options, RenderOptions& o) {
    o.want_color = false;
    for (const PlaneFile& file : options.files)
        for (const Aov aov : file.planes) switch (aov) {
                case Aov::kColor:
                    (file_content(options.extension) == FileContent::kLinear ? o.want_linear : o.want_color) = true;
                    break;
                case Aov::kAlpha:
                    o.want_alpha = true;
                    break;
                case Aov::kDepth:
                    o.want_depth = true;
                    break;
                case Aov::kNormal:
                    o.want_normal = true;
                    break;
                case Aov::kShadingNormal:
                    o.want_shading_normal = true;
                    break;
                case Aov::kUv:
                    o.want_uv = true;
                    break;
                case Aov::kPosition:
                    o.want_position = true;
                    break;
                case Aov::kAlbedo:
                    o.want_albedo = true;
                    break;
                case Aov::kNode:
                    o.want_node = true;
                    break;
                case Aov::kMaterial:
                    o.want_material = true;
                    break;
                case Aov::kPrimitive:
                    o.want_primitive = true;
                    break;
                case Aov::kMotion:
                case Aov::kMotionSeen:
                    o.want_motion = true;
                    break;
            }
}

}  // namespace tessera::cli
