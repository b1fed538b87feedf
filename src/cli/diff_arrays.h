// `tessera diff` of two NumPy arrays: exact planes of numbers, compared in their own unit.
#pragma once

#include <cstdint>
#include <string>

namespace tessera::cli {

// Told by the extension: .npy.
bool is_array(const std::string& path);

// Reads, compares and reports; the exit code. Arrays of different shape or type are different.
int diff_arrays(const std::string& first, const std::string& second, double tolerance, std::uint64_t max_differing,
                std::uint64_t max_pixels, bool json);

}  // namespace tessera::cli
