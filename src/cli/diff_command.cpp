// `tessera diff`: how far two pictures are apart; exit code 3 when too far.
#include "cli/commands.h"
#include "cli/diff_arrays.h"
#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/json_writer.h"
#include "cli/parse.h"
#include "cli/report.h"

#include <tessera/error.h>
#include <tessera/image_files.h>

#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

namespace tessera::cli {
namespace {

struct DiffArguments {
    std::string first, second, picture;
    std::string tolerance = "0", max_differing = "0", max_pixels = "268435456";
    bool json = false;
};

struct Verdict {
    std::uint64_t pixels = 0, allowed = 0;
    double tolerance = 0;
    bool same_size = true, equal = true;
    ImageDifference difference;
};

std::string shown(double value, const char* form) {
    char text[64];
    std::snprintf(text, sizeof text, form, value);
    return text;
}

std::string verdict_json(const DiffArguments& arguments, const Image& a, const Image& b, const Verdict& v) {
    JsonWriter json;
    json.begin_object().member("equal", v.equal).member("same_size", v.same_size);
    for (const auto& [key, file, image] :
         {std::tuple{"first", &arguments.first, &a}, {"second", &arguments.second, &b}}) {
        json.key(key).begin_object().member("file", *file);
        json.member("width", image->width()).member("height", image->height()).end_object();
    }
    json.member("tolerance", v.tolerance).member("max_differing", v.allowed);
    if (v.same_size) {
        json.member("pixels", v.pixels).member("differing_pixels", v.difference.differing_pixels);
        json.member("max_error", v.difference.max_error).member("mean_error", v.difference.mean_error);
        json.member("psnr_db", v.difference.psnr);  // null: infinite, the pictures are equal
    }
    return json.end_object().text();
}

std::string verdict_text(const Image& a, const Image& b, const Verdict& v) {
    const auto size = [](const Image& image) {
        return std::to_string(image.width()) + "x" + std::to_string(image.height());
    };
    if (!v.same_size) return "sizes differ: " + size(a) + " and " + size(b) + "\n";
    const char* unit = a.format() == PixelFormat::kRgba8    ? " / 255"
                       : a.format() == PixelFormat::kRgba16 ? " / 65535"
                                                            : "";
    std::string text = v.equal ? "equal" : "different";
    text += v.difference.differing_pixels > 0 && v.equal ? " within what is allowed\n" : "\n";
    text += "differing pixels: " + std::to_string(v.difference.differing_pixels) + " of " + std::to_string(v.pixels);
    text += "\nmax error:        " + shown(v.difference.max_error, "%g") + unit;
    text += "\nmean error:       " + shown(v.difference.mean_error, "%.6g") + unit;
    text += "\nPSNR:             ";
    const bool infinite = v.difference.psnr == std::numeric_limits<double>::infinity();
    return text + (infinite ? "infinite" : shown(v.difference.psnr, "%.2f") + " dB") + "\n";
}

bool is_floating(const Image& image) {
    return image.format() != PixelFormat::kRgba8 && image.format() != PixelFormat::kRgba16;
}

// What is compared: all channels of two EXR files, or RGBA. Two 16-bit pictures are compared as such, any
// other pair of whole numbers as 8 bits; floating-point values with the like only.
struct Pair {
    Image a, b;  // RGBA, or the first of the planes
    std::vector<ImagePlane> planes_a, planes_b;
};

Pair read_pair(const DiffArguments& arguments, std::uint64_t max_pixels) {
    Pair pair;
    pair.planes_a = read_exr_channels(arguments.first, max_pixels);
    if (!pair.planes_a.empty()) pair.planes_b = read_exr_channels(arguments.second, max_pixels);
    if (!pair.planes_b.empty()) {
        const auto names = [](const std::vector<ImagePlane>& planes) {
            std::string list;
            for (const ImagePlane& plane : planes) list.append(list.empty() ? "" : ", ").append(plane.name);
            return list;
        };
        const std::string first = names(pair.planes_a), second = names(pair.planes_b);
        if (first != second)
            throw Error(ErrorCode::kInput, "channels " + second + "; those of " + arguments.first + " are " + first,
                        arguments.second);
        pair.a = pair.planes_a[0].pixels, pair.b = pair.planes_b[0].pixels;
        return pair;
    }
    pair.planes_a.clear();
    const DecodeOptions all{max_pixels, true, true};
    pair.a = read_image(arguments.first, all), pair.b = read_image(arguments.second, all);
    if (is_floating(pair.a) != is_floating(pair.b))
        throw Error(ErrorCode::kInput,
                    "one picture has floating-point values, the other has not: they have no unit in common",
                    arguments.second);
    if (pair.a.format() != pair.b.format()) {
        pair.a = read_image(arguments.first, max_pixels);
        pair.b = read_image(arguments.second, max_pixels);
    }
    return pair;
}

// Of 8 bits, or of floats.
Image picture_of_pair(const DiffArguments& arguments, const Pair& pair, std::uint64_t max_pixels, double tolerance) {
    if (is_floating(pair.a)) {
        const DecodeOptions floats{max_pixels, false, true};
        return difference_picture(read_image(arguments.first, floats), read_image(arguments.second, floats), tolerance);
    }
    if (pair.a.format() == PixelFormat::kRgba8) return difference_picture(pair.a, pair.b, tolerance);
    return difference_picture(read_image(arguments.first, max_pixels), read_image(arguments.second, max_pixels),
                              tolerance / 257);
}

int run(const DiffArguments& arguments) {
    Verdict v;
    v.tolerance = parse_number("--tolerance", arguments.tolerance, 0, 1e30);
    v.allowed = static_cast<std::uint64_t>(parse_integer("--max-differing", arguments.max_differing, 0, INT64_MAX));
    const auto max_pixels =
        static_cast<std::uint64_t>(parse_integer("--max-pixels", arguments.max_pixels, 1, INT64_MAX));
    const std::string& picture = arguments.picture;
    if (!picture.empty() && !picture.ends_with(".png") && !picture.ends_with(".PNG") && !picture.starts_with("/dev/"))
        refuse("--output", "'" + picture + "' does not end in .png");
    if (!picture.empty()) check_writable(picture);
    if (is_array(arguments.first) || is_array(arguments.second)) {
        if (!picture.empty()) refuse("--output", "arrays have no picture of their differences");
        return diff_arrays(arguments.first, arguments.second, v.tolerance, v.allowed, max_pixels, arguments.json);
    }

    const Pair pair = read_pair(arguments, max_pixels);
    const Image &a = pair.a, &b = pair.b;
    v.pixels = static_cast<std::uint64_t>(a.width()) * static_cast<std::uint64_t>(a.height());
    v.same_size = a.width() == b.width() && a.height() == b.height();
    if (v.same_size)
        v.difference = pair.planes_a.empty() ? compare_images(a, b, v.tolerance)
                                             : compare_planes(pair.planes_a, pair.planes_b, v.tolerance);
    v.equal = v.same_size && v.difference.differing_pixels <= v.allowed;

    if (!picture.empty() && v.same_size)
        write_output(picture, encode_png(picture_of_pair(arguments, pair, max_pixels, v.tolerance)));
    write_output("-", arguments.json ? verdict_json(arguments, a, b, v) : verdict_text(a, b, v));
    return v.equal ? kFine : kComparisonFailed;
}

}  // namespace

Command add_diff_command(CLI::App& application) {
    CLI::App* app = application.add_subcommand("diff", "Compare two pictures; exit code 3 when they differ");
    auto arguments = std::make_shared<DiffArguments>();
    app->add_option("first", arguments->first, "picture: PNG, JPEG, WebP, TIFF, HDR or EXR; or array (.npy)")
        ->required()
        ->option_text("");
    app->add_option("second", arguments->second, "picture or array to compare with it")->required()->option_text("");
    app->add_option("-o,--output", arguments->picture, "write a PNG of the first picture in grey, differences in red")
        ->option_text("FILE");
    app->add_option("--tolerance", arguments->tolerance,
                    "a pixel differs when a channel is off by more, in 1/255 (16-bit pictures: 1/65535; floating-point "
                    "ones and arrays: in their own unit; two EXR files: in any of their channels; default 0)")
        ->option_text("N");
    app->add_option("--max-differing", arguments->max_differing, "so many pixels may differ (default 0)")
        ->option_text("N");
    app->add_option("--max-pixels", arguments->max_pixels,
                    "refuse larger pictures (default 268435456); floating-point ones take 16 bytes a pixel")
        ->option_text("N");
    app->add_flag("--json", arguments->json, "report as JSON");
    return {app, [arguments] { return run(*arguments); }};
}

}  // namespace tessera::cli
