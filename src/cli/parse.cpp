#include "cli/parse.h"

#include <tessera/error.h>
#include <tessera/image.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera::cli {
namespace {

// The whole of `text` as a T, or nothing. A leading plus sign is allowed.
template <class T>
std::optional<T> whole(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts(1);
    for (const char c : text)
        if (c == separator)
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

// Large values print as they were meant, small ones without trailing zeros.
std::string shown(double value) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 10).ptr;
    return {buffer, end};
}

std::optional<Vec4> hexadecimal_color(const std::string& digits) {
    if (digits.size() != 6 && digits.size() != 8) return std::nullopt;
    std::array<float, 4> channels{0, 0, 0, 1};
    for (std::size_t i = 0; i < digits.size() / 2; ++i) {
        unsigned value = 0;
        const char* first = digits.data() + 2 * i;
        const auto [end, error] = std::from_chars(first, first + 2, value, 16);
        if (error != std::errc{} || end != first + 2) return std::nullopt;
        channels[i] = static_cast<float>(value) / 255.0f;
    }
    return Vec4{channels[0], channels[1], channels[2], channels[3]};
}

struct NamedColor {
    std::string_view name;
    std::string_view digits;
};
constexpr NamedColor kNamedColors[] = {
    {"white", "ffffff"},  {"black", "000000"}, {"grey", "808080"},    {"gray", "808080"},          {"silver", "c0c0c0"},
    {"red", "ff0000"},    {"green", "008000"}, {"lime", "00ff00"},    {"blue", "0000ff"},          {"yellow", "ffff00"},
    {"cyan", "00ffff"},   {"aqua", "00ffff"},  {"magenta", "ff00ff"}, {"fuchsia", "ff00ff"},       {"orange", "ffa500"},
    {"purple", "800080"}, {"navy", "000080"},  {"teal", "008080"},    {"maroon", "800000"},        {"olive", "808000"},
    {"pink", "ffc0cb"},   {"brown", "a52a2a"}, {"skyblue", "87ceeb"}, {"transparent", "00000000"},
};

}  // namespace

void refuse(const std::string& option, const std::string& reason) {
    throw Error(ErrorCode::kUsage, option + ": " + reason);
}

double parse_number(const std::string& option, const std::string& text, double low, double high) {
    const auto value = whole<double>(text);
    if (!value || !std::isfinite(*value)) refuse(option, "'" + text + "' is not a number");
    if (*value < low || *value > high) refuse(option, text + " is outside " + shown(low) + " .. " + shown(high));
    return *value;
}

std::int64_t parse_integer(const std::string& option, const std::string& text, std::int64_t low, std::int64_t high) {
    const auto value = whole<std::int64_t>(text);
    if (!value) refuse(option, "'" + text + "' is not a whole number");
    if (*value < low || *value > high)
        refuse(option, text + " is outside " + std::to_string(low) + " .. " + std::to_string(high));
    return *value;
}

std::uint64_t parse_bytes(const std::string& option, const std::string& text) {
    std::string digits = text;
    unsigned shift = 0;
    if (!digits.empty()) {
        const auto unit = std::string_view("KMGT").find(digits.back());
        if (unit != std::string_view::npos) {
            shift = 10 * (static_cast<unsigned>(unit) + 1);
            digits.pop_back();
        }
    }
    const auto value = whole<std::uint64_t>(digits);
    if (!value || *value == 0) refuse(option, "'" + text + "' is not a count such as 1000000, 512M or 2G");
    if (*value > (std::numeric_limits<std::uint64_t>::max() >> shift)) refuse(option, text + " is too large");
    return *value << shift;
}

Size parse_size(const std::string& option, const std::string& text) {
    const auto parts = split(text, 'x');
    if (parts.size() != 2) refuse(option, "'" + text + "' is not a size such as 1024x768");
    return {static_cast<int>(parse_integer(option, parts[0], 1, kMaxImageSide)),
            static_cast<int>(parse_integer(option, parts[1], 1, kMaxImageSide))};
}

Vec3 parse_vector(const std::string& option, const std::string& text) {
    const auto parts = split(text, ',');
    if (parts.size() != 3) refuse(option, "'" + text + "' is not three numbers such as 1,2.5,-3");
    std::array<float, 3> v{};
    constexpr double kLargest = 1e30;
    for (std::size_t i = 0; i < 3; ++i) v[i] = static_cast<float>(parse_number(option, parts[i], -kLargest, kLargest));
    return {v[0], v[1], v[2]};
}

Intrinsics parse_intrinsics(const std::string& option, const std::string& text) {
    const auto parts = split(text, ',');
    if (parts.size() != 4) refuse(option, "'" + text + "' is not FX,FY,CX,CY");
    constexpr double kLargest = 1e9;
    return {parse_number(option, parts[0], 1e-3, kLargest), parse_number(option, parts[1], 1e-3, kLargest),
            parse_number(option, parts[2], -kLargest, kLargest), parse_number(option, parts[3], -kLargest, kLargest)};
}

std::optional<Vec4> parse_background(const std::string& option, const std::string& text) {
    if (text == "none") return std::nullopt;
    if (!text.empty() && text[0] == '#')
        if (const auto color = hexadecimal_color(text.substr(1))) return color;
    for (const auto& [name, digits] : kNamedColors)
        if (text == name) return hexadecimal_color(std::string(digits));
    const auto parts = split(text, ',');
    if (parts.size() == 3 || parts.size() == 4) {
        std::array<float, 4> v{0, 0, 0, 1};
        for (std::size_t i = 0; i < parts.size(); ++i) v[i] = static_cast<float>(parse_number(option, parts[i], 0, 1));
        return Vec4{v[0], v[1], v[2], v[3]};
    }
    refuse(option, "'" + text + "' is not none, #rrggbb, #rrggbbaa, r,g,b[,a] (each 0 .. 1) or a colour's name");
}

std::array<int, 3> parse_color_bits(const std::string& option, const std::string& text) {
    const auto parts = split(text, '-');
    if (parts.size() != 3) refuse(option, "'" + text + "' is not three bit counts such as 3-3-2");
    std::array<int, 3> bits{};
    for (std::size_t i = 0; i < 3; ++i) bits[i] = static_cast<int>(parse_integer(option, parts[i], 1, 8));
    return bits;
}

}  // namespace tessera::cli
