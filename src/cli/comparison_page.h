// The comparison of a batch with its reference as one HTML file for people: pictures are inside it (data: URIs),
// nothing is loaded from elsewhere and no script runs. What differs comes first, the worst at the top: reference, new
// picture and difference side by side. What passes is folded away.
#pragma once

#include "cli/batch_report.h"

#include <cstdint>
#include <string>

namespace tessera::cli {

// Of pictures in a page: what browsers still open.
inline constexpr std::uint64_t kPageBytes = std::uint64_t{256} << 20;

// Reads the pictures that the report names. Once they come to `max_bytes` the rest is listed without; the page says so.
std::string comparison_page(const BatchReport& report, std::uint64_t max_bytes);

}  // namespace tessera::cli
