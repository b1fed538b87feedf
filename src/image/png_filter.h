// PNG row filters (PNG specification, third edition, section 9): which one suits a row, and the
// filtered bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

class PngFilter {
  public:
    // Rows of `row_bytes` bytes, pixels of `pixel_bytes`. Room for the candidates is kept between rows.
    PngFilter(std::size_t row_bytes, std::size_t pixel_bytes);

    // Writes the filter's number and `row_bytes` filtered bytes to `out`. `above` is the row above in
    // the picture, or null for the first one.
    void apply(const std::uint8_t* row, const std::uint8_t* above, std::uint8_t* out);

  private:
    std::size_t row_bytes_, pixel_bytes_;
    std::vector<std::uint8_t> zero_, sub_, up_, paeth_;
};

}  // namespace tessera
