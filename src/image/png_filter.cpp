// The loops are written so that compilers vectorise them for the baseline instruction set.
#include "image/png_filter.h"

#include <cstdlib>
#include <cstring>

namespace tessera {
namespace {

// The predictor of section 9.4: of left a, above b and upper left c the one nearest to a + b - c.
inline std::uint8_t paeth(std::uint8_t a, std::uint8_t b, std::uint8_t c) {
    const auto along = static_cast<std::int16_t>(b - c), down = static_cast<std::int16_t>(a - c);
    const auto pa = static_cast<std::int16_t>(std::abs(along)), pb = static_cast<std::int16_t>(std::abs(down));
    const auto pc = static_cast<std::int16_t>(std::abs(along + down));
    const std::uint8_t bc = pb <= pc ? b : c;
    const std::int16_t least = pb <= pc ? pb : pc;
    return pa <= least ? a : bc;
}

// The sum of the filtered bytes taken as signed, without sign: small when the row will compress well
// (section 12.7).
std::uint32_t cost(const std::uint8_t* bytes, std::size_t count) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto up = bytes[i], down = static_cast<std::uint8_t>(-bytes[i]);
        sum += up < down ? up : down;
    }
    return sum;
}

}  // namespace

PngFilter::PngFilter(std::size_t row_bytes, std::size_t pixel_bytes)
    : row_bytes_(row_bytes),
      pixel_bytes_(pixel_bytes),
      zero_(row_bytes),
      sub_(row_bytes),
      up_(row_bytes),
      paeth_(row_bytes) {}

void PngFilter::apply(const std::uint8_t* row, const std::uint8_t* above, std::uint8_t* out) {
    const std::size_t n = row_bytes_, p = pixel_bytes_;
    if (above == nullptr) above = zero_.data();
    std::uint8_t *sub = sub_.data(), *up = up_.data(), *best_paeth = paeth_.data();

    for (std::size_t i = 0; i < n; ++i) up[i] = static_cast<std::uint8_t>(row[i] - above[i]);
    for (std::size_t i = 0; i < p; ++i) sub[i] = row[i], best_paeth[i] = up[i];
    for (std::size_t i = p; i < n; ++i) sub[i] = static_cast<std::uint8_t>(row[i] - row[i - p]);
    for (std::size_t i = p; i < n; ++i)
        best_paeth[i] = static_cast<std::uint8_t>(row[i] - paeth(row[i - p], above[i], above[i - p]));

    const std::uint32_t sub_cost = cost(sub, n), up_cost = cost(up, n), paeth_cost = cost(best_paeth, n);
    const std::uint8_t* chosen = sub;
    out[0] = 1;
    if (up_cost < sub_cost) chosen = up, out[0] = 2;
    if (paeth_cost < (up_cost < sub_cost ? up_cost : sub_cost)) chosen = best_paeth, out[0] = 4;
    std::memcpy(out + 1, chosen, n);
}

}  // namespace tessera
