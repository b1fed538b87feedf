// Formats of pictures that are known by their bytes but not read, for messages that name them.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace tessera {

// "BMP", "GIF", "TGA" or "PSD"; empty for whatever else.
inline std::string_view foreign_picture_format(std::span<const std::byte> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (text.starts_with("GIF87a") || text.starts_with("GIF89a")) return "GIF";
    if (text.starts_with("8BPS")) return "PSD";
    constexpr std::size_t kBmpHeaders = 26;
    if (text.starts_with("BM") && text.size() >= kBmpHeaders) return "BMP";
    // TGA 2.0 has a mark at its end; before that there was only a header of 18 bytes, whose colour map is none or one,
    // of a kind of picture and with a depth that exist.
    if (text.ends_with(std::string_view("TRUEVISION-XFILE.\0", 18))) return "TGA";
    constexpr std::size_t kTgaHeader = 18;
    if (text.size() <= kTgaHeader) return {};
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
    const unsigned kind = byte(2) & ~8u, depth = byte(16);
    const bool is_tga = byte(1) <= 1 && kind >= 1 && kind <= 3 && byte(2) <= 11 && (kind == 1) == (byte(1) == 1) &&
                        (depth == 8 || depth == 15 || depth == 16 || depth == 24 || depth == 32);
    return is_tga ? "TGA" : std::string_view();
}

}  // namespace tessera
