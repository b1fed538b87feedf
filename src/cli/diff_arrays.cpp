#include "cli/diff_arrays.h"

#include "cli/exit_code.h"
#include "cli/files.h"
#include "cli/json_writer.h"

#include <tessera/error.h>
#include <tessera/planes.h>

#include <cstdio>
#include <optional>

namespace tessera::cli {
namespace {

// "<f4 of 640x480x3"
std::string described(const NpyArray& a) {
    std::string text(name(a.type));
    text.append(" of ").append(std::to_string(a.width)).append("x").append(std::to_string(a.height));
    return a.components == 1 ? text : text + "x" + std::to_string(a.components);
}

std::string shown(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

void write_side(JsonWriter& writer, const char* key, const std::string& file, const NpyArray& a) {
    writer.key(key).begin_object().member("file", file).member("type", std::string(name(a.type)));
    writer.member("width", a.width).member("height", a.height).member("components", a.components).end_object();
}

}  // namespace

bool is_array(const std::string& path) { return path.ends_with(".npy") || path.ends_with(".NPY"); }

int diff_arrays(const std::string& first, const std::string& second, double tolerance, std::uint64_t max_differing,
                std::uint64_t max_pixels, bool json) {
    if (!is_array(first) || !is_array(second))
        throw Error(ErrorCode::kUsage, "an array (.npy) can be compared with an array only");
    const NpyArray a = read_npy(first, max_pixels), b = read_npy(second, max_pixels);
    const bool alike = a.width == b.width && a.height == b.height && a.components == b.components && a.type == b.type;
    std::optional<ImageDifference> difference;
    if (alike) difference = compare_arrays(a, b, tolerance);
    const bool equal = alike && difference->differing_pixels <= max_differing;
    const std::uint64_t pixels = static_cast<std::uint64_t>(a.width) * static_cast<std::uint64_t>(a.height);

    std::string text;
    if (json) {
        JsonWriter writer;
        writer.begin_object().member("equal", equal).member("same_shape", alike);
        write_side(writer, "first", first, a);
        write_side(writer, "second", second, b);
        writer.member("tolerance", tolerance).member("max_differing", max_differing);
        if (alike) {
            writer.member("pixels", pixels).member("differing_pixels", difference->differing_pixels);
            writer.member("max_error", difference->max_error).member("mean_error", difference->mean_error);
        }
        text = writer.end_object().text();
    } else if (!alike) {
        text.append("arrays differ: ").append(described(a)).append(" and ").append(described(b)).append("\n");
    } else {
        text = equal ? "equal" : "different";
        text += difference->differing_pixels > 0 && equal ? " within what is allowed\n" : "\n";
        text.append("differing pixels: ").append(std::to_string(difference->differing_pixels));
        text.append(" of ").append(std::to_string(pixels));
        text.append("\nmax error:        ").append(shown(difference->max_error));
        text.append("\nmean error:       ").append(shown(difference->mean_error)).append("\n");
    }
    write_output("-", text);
    return equal ? kFine : kComparisonFailed;
}

}  // namespace tessera::cli
