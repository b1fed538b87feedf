// `tessera diff`: how far two pictures are apart; exit code 3 when too far.
#include "cli/commands.h"
#include "cli/diff_arrays.h"
#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/json_writer.h"
#include "cli/parse.h"
#include "cli/report.h"

#include <tessera/error.h>
#include <tessera/image.h>

#include <cstdio>
#include <limits>
#include <memory>

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
    const char* unit = a.format() == PixelFormat::kRgba16 ? " / 65535" : " / 255";
    std::string text = v.equal ? "equal" : "different";
    text += v.difference.differing_pixels > 0 && v.equal ? " within what is allowed\n" : "\n";
    text += "differing pixels: " + std::to_string(v.difference.differing_pixels) + " of " + std::to_string(v.pixels);
    text += "\nmax error:        " + shown(v.difference.max_error, "%g") + unit;
    text += "\nmean error:       " + shown(v.difference.mean_error, "%.6g") + unit;
    text += "\nPSNR:             ";
    const bool infinite = v.difference.psnr == std::numeric_limits<double>::infinity();
    return text + (infinite ? "infinite" : shown(v.difference.psnr, "%.2f") + " dB") + "\n";
}

int run(const DiffArguments& arguments) {
    Verdict v;
    v.tolerance = parse_number("--tolerance", arguments.tolerance, 0, 65535);
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

    // Two 16-bit pictures are compared as such, any other pair as 8 bits.
    Image a = read_image(arguments.first, max_pixels, true), b = read_image(arguments.second, max_pixels, true);
    if (a.format() != b.format()) {
        a = read_image(arguments.first, max_pixels);
        b = read_image(arguments.second, max_pixels);
    }
    v.pixels = static_cast<std::uint64_t>(a.width()) * static_cast<std::uint64_t>(a.height());
    v.same_size = a.width() == b.width() && a.height() == b.height();
    if (v.same_size) v.difference = compare_images(a, b, v.tolerance);
    v.equal = v.same_size && v.difference.differing_pixels <= v.allowed;

    if (!picture.empty() && v.same_size) {
        const bool deep = a.format() == PixelFormat::kRgba16;
        const double tolerance = deep ? v.tolerance / 257 : v.tolerance;
        write_output(picture, encode_png(deep ? difference_picture(read_image(arguments.first, max_pixels),
                                                                   read_image(arguments.second, max_pixels), tolerance)
                                              : difference_picture(a, b, tolerance)));
    }
    write_output("-", arguments.json ? verdict_json(arguments, a, b, v) : verdict_text(a, b, v));
    return v.equal ? kFine : kComparisonFailed;
}

}  // namespace

Command add_diff_command(CLI::App& application) {
    CLI::App* app = application.add_subcommand("diff", "Compare two pictures; exit code 3 when they differ");
    auto arguments = std::make_shared<DiffArguments>();
    app->add_option("first", arguments->first, "picture (.png, .jpg) or array (.npy)")->required()->option_text("");
    app->add_option("second", arguments->second, "picture or array to compare with it")->required()->option_text("");
    app->add_option("-o,--output", arguments->picture, "write a PNG of the first picture in grey, differences in red")
        ->option_text("FILE");
    app->add_option(
           "--tolerance", arguments->tolerance,
           "a pixel differs when a channel is off by more, in 1/255 (16-bit pictures: 1/65535; arrays: their unit; "
           "default 0)")
        ->option_text("N");
    app->add_option("--max-differing", arguments->max_differing, "so many pixels may differ (default 0)")
        ->option_text("N");
    app->add_option("--max-pixels", arguments->max_pixels, "refuse larger pictures (default 268435456)")
        ->option_text("N");
    app->add_flag("--json", arguments->json, "report as JSON");
    return {app, [arguments] { return run(*arguments); }};
}

}  // namespace tessera::cli
