#include "cli/reference.h"

#include "cli/files.h"

#include <tessera/error.h>
#include <tessera/image.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>

namespace tessera::cli {
namespace {

namespace fs = std::filesystem;

bool is_picture(std::span<const std::byte> file) {
    try {
        read_image_info(file);
        return true;
    } catch (const Error&) {
        return false;
    }
}

void write_difference(const ReferenceOptions& options, const std::string& name, const Image& reference,
                      const Image& written, Comparison& c) {
    c.difference = (fs::path(options.differences) / (name + ".difference.png")).string();
    make_folders_of(c.difference);
    write_output(c.difference, encode_png(difference_picture(reference, written, options.tolerance), {.threads = 1}));
}

}  // namespace

Comparison compare_with_reference(const ReferenceOptions& options, const std::string& name,
                                  std::span<const std::byte> written) {
    Comparison c;
    c.reference = (fs::path(options.folder) / name).string();
    std::error_code unknown;
    if (!fs::exists(c.reference, unknown)) {
        c.verdict = Verdict::kMissing;
        return c;
    }
    std::vector<std::byte> earlier;
    try {
        earlier = read_file(c.reference);
    } catch (const Error&) {
        c.verdict = Verdict::kUnreadable;
        return c;
    }
    if (std::equal(earlier.begin(), earlier.end(), written.begin(), written.end())) return c;
    if (!is_picture(written)) {
        c.verdict = Verdict::kDifferent;
        return c;
    }
    try {
        Image a = decode_image(earlier, options.max_pixels, true), b = decode_image(written, options.max_pixels, true);
        if (a.format() != b.format())
            a = decode_image(earlier, options.max_pixels), b = decode_image(written, options.max_pixels);
        if (a.width() != b.width() || a.height() != b.height()) {
            c.verdict = Verdict::kOtherSize;
            return c;
        }
        const double unit = a.format() == PixelFormat::kRgba16 ? 257 : 1;
        const ImageDifference d = compare_images(a, b, options.tolerance * unit);
        c.pixels = static_cast<std::uint64_t>(a.width()) * static_cast<std::uint64_t>(a.height());
        c.differing_pixels = d.differing_pixels;
        c.max_error = d.max_error / unit, c.mean_error = d.mean_error / unit;
        if (d.psnr < std::numeric_limits<double>::infinity()) c.psnr = d.psnr;
        c.verdict = d.differing_pixels > options.max_differing ? Verdict::kDifferent
                    : d.max_error > 0                          ? Verdict::kWithin
                                                               : Verdict::kEqual;
        if (c.verdict != Verdict::kDifferent) return c;
        if (unit != 1) a = decode_image(earlier, options.max_pixels), b = decode_image(written, options.max_pixels);
        write_difference(options, name, a, b, c);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::kOutput) throw;
        c.verdict = Verdict::kUnreadable;
    }
    return c;
}

}  // namespace tessera::cli
