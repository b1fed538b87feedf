// Vectors of pixels between blocks of a tile and rows of the picture. Part of the kernel files, once
// per instruction set.
#pragma once

#include "tile/tile_data.h"

namespace tessera::TESSERA_ISA_NAMESPACE {

// How a block of 8x8 pixels falls into vectors, row after row: kRows rows in a vector, or kPerRow
// vectors in a row.
inline constexpr int kRows = kLanes<Float> > kBlockSide ? kLanes<Float> / kBlockSide : 1;
inline constexpr int kPerRow = kLanes<Float> < kBlockSide ? kBlockSide / kLanes<Float> : 1;
inline constexpr int kPixelColumns = kLanes<Float> < kBlockSide ? kLanes<Float> : kBlockSide;
TESSERA_INLINE Int lane_column() { return iota<Int>() & Int(kBlockSide - 1); }
TESSERA_INLINE Int lane_row() { return iota<Int>() >> 3; }

// Writes a vector of numbers of 4 bytes of a block to rows of the picture, as far as they lie in it.
// (x, y): the vector's first pixel in the tile.
TESSERA_INLINE void store_pixels(const Uint& values, unsigned char* first_pixel, const TileWindow& window, int x,
                                 int y) {
    unsigned char* const first =
        first_pixel + static_cast<std::size_t>(y) * window.stride + 4 * static_cast<std::size_t>(x);
    if (x + kPixelColumns <= window.width && y + kRows <= window.height)
        return store_eights([=](int row) { return first + static_cast<std::size_t>(row) * window.stride; }, values);
    alignas(64) std::uint32_t all[kLanes<Float>];
    store(all, values);
    for (int row = 0; row < kRows; ++row) {
        if (y + row >= window.height) return;
        unsigned char* const to = first + static_cast<std::size_t>(row) * window.stride;
        if (x + kPixelColumns <= window.width)
            __builtin_memcpy(to, all + row * kPixelColumns, 4 * kPixelColumns);
        else if (x < window.width)
            __builtin_memcpy(to, all + row * kPixelColumns, 4 * static_cast<std::size_t>(window.width - x));
    }
}

// Writes two blocks side by side, whose rows are whole cache lines: value(i) are their vectors, the left block's first.
// (x, y): the first pixel in the tile.
template <class Value>
TESSERA_INLINE void write_pair(unsigned char* first_pixel, const TileWindow& window, int x, int y, Value&& value) {
    constexpr int kBlockVectors = kBlockPixels / kLanes<Float>;
    const bool streamed = window.streamed && x + 2 * kBlockSide <= window.width && y + kBlockSide <= window.height;
    for (int i = 0; i < kBlockVectors; ++i) {
        const int at = i * kLanes<Float>, column = x + at % kBlockSide, row = y + at / kBlockSide;
        const Uint left = value(i), right = value(i + kBlockVectors);
        if (streamed) {
            unsigned char* const first =
                first_pixel + static_cast<std::size_t>(row) * window.stride + 4 * static_cast<std::size_t>(column);
            stream_eights(
                [=](int r) {
                    return reinterpret_cast<std::uint32_t*>(first + static_cast<std::size_t>(r) * window.stride);
                },
                left, right);
        } else {
            store_pixels(left, first_pixel, window, column, row);
            store_pixels(right, first_pixel, window, column + kBlockSide, row);
        }
    }
}

// Writes a tile: value(place) is the vector of its pixels from there on.
template <class Value>
TESSERA_INLINE void write_tile(unsigned char* first_pixel, const TileWindow& window, Value&& value) {
    const int blocks = window.side / kBlockSide;
    for (int by = 0; by * kBlockSide < window.height; ++by)
        for (int bx = 0; bx * kBlockSide < window.width; bx += 2)
            write_pair(first_pixel, window, bx * kBlockSide, by * kBlockSide, [&](int i) TESSERA_INLINE_LAMBDA {
                return value((by * blocks + bx) * kBlockPixels + i * kLanes<Float>);
            });
    if (window.streamed) flush_streams();
}

// Writes the same pixel everywhere in a tile.
inline void fill_tile(unsigned char* first_pixel, const TileWindow& window, Uint pixels) {
    alignas(64) std::uint32_t row[kMaxTileSide];
    for (int x = 0; x < kMaxTileSide; x += kLanes<Float>) store(row + x, pixels);
    const bool streamed = window.streamed && window.width % (2 * kBlockSide) == 0;
    for (int y = 0; y < window.height; ++y) {
        unsigned char* const to = first_pixel + static_cast<std::size_t>(y) * window.stride;
        if (streamed)
            for (int x = 0; x < window.width; x += kLanes<Float>)
                stream(reinterpret_cast<std::uint32_t*>(to) + x, pixels);
        else
            __builtin_memcpy(to, row, 4 * static_cast<std::size_t>(window.width));
    }
    if (streamed) flush_streams();
}

// Display values of a vector of pixels, RGBA from the lowest byte on.
TESSERA_INLINE Uint display_pixels(const FilmView& film, const Vec3T<Float>& premultiplied, Float coverage) {
    const DisplayPixel<Float> d = develop(film, premultiplied, coverage);
    return as_uint(d.r | (d.g << 8) | (d.b << 16) | (d.a << 24));
}

}  // namespace tessera::TESSERA_ISA_NAMESPACE
