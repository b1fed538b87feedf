// Writing PNG below the level of images: rows of samples, packed as PNG stores them, to a file. The rows
// are asked for by several threads, a row perhaps twice, so packing must not change anything.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace tessera {

class Arena;

// Colour types of the PNG specification (third edition, section 11.2.1).
enum class PngColor : std::uint8_t { kGrey = 0, kRgb = 2, kPalette = 3, kRgba = 6 };

struct PngRows {
    int width = 0, height = 0;
    int bits = 8;  // of a sample: 8 or 16; 1, 2, 4 or 8 of a palette's index
    PngColor color = PngColor::kRgba;
    bool is_picture = true;                    // display codes (an sRGB chunk says so), not numbers
    std::vector<std::uint8_t> palette, alpha;  // contents of PLTE and tRNS
    // Writes row y: samples of 16 bits with the high byte first, small ones from the high bits on.
    std::function<void(std::size_t y, std::uint8_t* out)> pack;
};

// The file, deflated at `level` (0 .. 12, kUsage otherwise) on the threads of `arena`; the bytes do not
// depend on their number.
std::vector<std::byte> write_png(const PngRows& rows, int level, Arena& arena);

}  // namespace tessera
