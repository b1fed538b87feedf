// Comparison of a batch's pictures with earlier ones of the same names under another folder. Pictures are compared by
// their pixels, 16-bit ones as such, all figures in 1/255; files that are no PNG or JPEG by their bytes. Any thread may
// call.
#pragma once

#include "cli/batch_report.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tessera::cli {

struct ReferenceOptions {
    std::string folder;       // of the earlier pictures
    std::string differences;  // where pictures of the differences go; made when there is one, old ones removed
    double tolerance = 0;     // a pixel differs when a channel is off by more, in 1/255 or the own unit
    std::uint64_t max_differing = 0;
    std::uint64_t max_pixels = 0;
};

// `name` is that of the file below both folders, `written` its contents. Throws kOutput when the picture of the
// difference cannot be written.
Comparison compare_with_reference(const ReferenceOptions& options, const std::string& name,
                                  std::span<const std::byte> written);

}  // namespace tessera::cli
