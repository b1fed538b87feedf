// Vectors of pixels between blocks of a tile and rows of the picture. Part of the kernel files, once
// per instruction set.
#pragma once

#include "raster/raster_data.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// How a block of 8x8 pixels falls into vectors, row after row: kRows rows in a vector, or kPerRow
// vectors in a row.
inline constexpr int kRows = kLanes<Float> > kBlockSide ? kLanes<Float> / kBlockSide : 1;
inline constexpr int kPerRow = kLanes<Float> < kBlockSide ? kBlockSide / kLanes<Float> : 1;
inline constexpr int kLinePixels = 64 / 4;  // of a cache line
inline constexpr int kPixelColumns = kLanes<Float> < kBlockSide ? kLanes<Float> : kBlockSide;
TESSERA_INLINE Int lane_column() { return iota<Int>() & Int(kBlockSide - 1); }
TESSERA_INLINE Int lane_row() { return iota<Int>() >> 3; }

// Writes a vector of numbers of 4 bytes of a block to rows of the picture, as far as they lie in it.
// (x, y): the vector's first pixel in the tile.
TESSERA_INLINE void store_pixels(const Uint& values, unsigned char* first_pixel, std::size_t stride, int x, int y,
                                 int width, int height) {
    unsigned char* const first = first_pixel + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(x);
    if (x + kPixelColumns <= width && y + kRows <= height)
        return store_eights([=](int row) { return first + static_cast<std::size_t>(row) * stride; }, values);
    alignas(64) std::uint32_t all[kLanes<Float>];
    store(all, values);
    for (int row = 0; row < kRows; ++row) {
        if (y + row >= height) return;
        unsigned char* const to = first + static_cast<std::size_t>(row) * stride;
        if (x + kPixelColumns <= width)
            __builtin_memcpy(to, all + row * kPixelColumns, 4 * kPixelColumns);
        else if (x < width)
            __builtin_memcpy(to, all + row * kPixelColumns, 4 * static_cast<std::size_t>(width - x));
    }
}

// The same for two blocks side by side that lie in the picture, past the caches. (x, y): the left one's.
TESSERA_INLINE void stream_pixels(const Uint& left, const Uint& right, unsigned char* first_pixel, std::size_t stride,
                                  int x, int y) {
    unsigned char* const first = first_pixel + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(x);
    stream_eights(
        [=](int row) { return reinterpret_cast<std::uint32_t*>(first + static_cast<std::size_t>(row) * stride); }, left,
        right);
}

// Display values of a vector of pixels, RGBA from the lowest byte on.
TESSERA_INLINE Uint display_pixels(const FilmView& film, const Vec3T<Float>& premultiplied, Float coverage) {
    const DisplayPixel<Float> d = develop(film, premultiplied, coverage);
    return as_uint(d.r | (d.g << 8) | (d.b << 16) | (d.a << 24));
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
