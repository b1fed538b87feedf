// Values of options as text: sizes, vectors, colours, byte counts. Numbers are read without a locale
// and must be the whole text. Each function throws tessera::Error (kUsage) that names `option`.
#pragma once

#include <tessera/types.h>
#include <tessera/view.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace tessera::cli {

[[noreturn]] void refuse(const std::string& option, const std::string& reason);

// A finite number in [low, high].
double parse_number(const std::string& option, const std::string& text, double low, double high);
// An integer in [low, high].
std::int64_t parse_integer(const std::string& option, const std::string& text, std::int64_t low, std::int64_t high);
// A count of bytes, with K, M, G or T for powers of 1024.
std::uint64_t parse_bytes(const std::string& option, const std::string& text);

struct Size {
    int width, height;
};
// "640x480"
Size parse_size(const std::string& option, const std::string& text);
// "1,2.5,-3"
Vec3 parse_vector(const std::string& option, const std::string& text);
// "fx,fy,cx,cy", of which the first two are positive.
Intrinsics parse_intrinsics(const std::string& option, const std::string& text);
// "none" (empty), "#rrggbb", "#rrggbbaa", "r,g,b", "r,g,b,a" (0 .. 1) or a name: display colour and alpha.
std::optional<Vec4> parse_background(const std::string& option, const std::string& text);
// "3-3-2": bits of red, green and blue.
std::array<int, 3> parse_color_bits(const std::string& option, const std::string& text);

}  // namespace tessera::cli
