#include "cli/reference.h"

#include "cli/files.h"

#include <tessera/error.h>
#include <tessera/image_files.h>
#include <tessera/planes.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <vector>

namespace tessera::cli {
namespace {

namespace fs = std::filesystem;
using File = std::span<const std::byte>;

bool is_floating(const Image& image) { return image.format() == PixelFormat::kRgba32f; }

// What two files have apart; nothing where they cannot be laid over each other.
struct Measured {
    std::optional<ImageDifference> difference;
    std::uint64_t pixels = 0;
    double unit = 1;        // of the difference, in those of the tolerance
    bool floating = false;  // numbers in a unit of their own, not in 1/255
};

std::uint64_t pixels_of(int width, int height) {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
}

Measured measure_arrays(File earlier, File written, const ReferenceOptions& options) {
    const NpyArray a = decode_npy(earlier, options.max_pixels), b = decode_npy(written, options.max_pixels);
    Measured m{{}, pixels_of(a.width, a.height), 1, true};
    if (a.width == b.width && a.height == b.height && a.components == b.components && a.type == b.type)
        m.difference = compare_arrays(a, b, options.tolerance);
    return m;
}

Measured measure_channels(File earlier, File written, const ReferenceOptions& options) {
    const std::vector<ImagePlane> a = decode_exr_channels(earlier, options.max_pixels),
                                  b = decode_exr_channels(written, options.max_pixels);
    const bool alike = std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ImagePlane& x, const ImagePlane& y) {
        return x.name == y.name && x.pixels.format() == y.pixels.format() && x.pixels.width() == y.pixels.width() &&
               x.pixels.height() == y.pixels.height();
    });
    Measured m{{}, a.empty() ? 0 : pixels_of(a[0].pixels.width(), a[0].pixels.height()), 1, true};
    if (alike && !a.empty()) m.difference = compare_planes(a, b, options.tolerance);
    return m;
}

// Two pictures as they are, else as 8 bits.
Measured measure_pictures(File earlier, File written, const ReferenceOptions& options) {
    const DecodeOptions all{options.max_pixels, true, true};
    Image a = decode_image(earlier, all), b = decode_image(written, all);
    if (a.format() != b.format() && !is_floating(a) && !is_floating(b))
        a = decode_image(earlier, options.max_pixels), b = decode_image(written, options.max_pixels);
    Measured m{{}, pixels_of(a.width(), a.height()), a.format() == PixelFormat::kRgba16 ? 257.0 : 1.0, is_floating(a)};
    if (a.format() == b.format() && a.width() == b.width() && a.height() == b.height())
        m.difference = compare_images(a, b, options.tolerance * m.unit);
    return m;
}

bool is_exr(File file) {
    constexpr unsigned char kMagic[] = {0x76, 0x2f, 0x31, 0x01};
    return file.size() > 4 &&
           std::equal(std::begin(kMagic), std::end(kMagic), file.begin(),
                      [](unsigned char a, std::byte b) { return a == static_cast<unsigned char>(b); });
}

Measured measure(File earlier, File written, const ReferenceOptions& options) {
    if (is_npy(written)) return measure_arrays(earlier, written, options);
    if (is_exr(written)) return measure_channels(earlier, written, options);
    return measure_pictures(earlier, written, options);
}

std::string difference_file(const ReferenceOptions& options, const std::string& name) {
    return (fs::path(options.differences) / (name + ".difference.png")).string();
}

// The picture of the difference of two that are seen as pictures.
void write_difference(const ReferenceOptions& options, const std::string& name, File earlier, File written,
                      bool floating, Comparison& c) {
    const DecodeOptions shown{options.max_pixels, false, floating};
    c.difference = difference_file(options, name);
    make_folders_of(c.difference);
    PngOptions png;
    png.threads = 1;
    write_output(c.difference, encode_png(difference_picture(decode_image(earlier, shown), decode_image(written, shown),
                                                             options.tolerance),
                                          png));
}

}  // namespace

Comparison compare_with_reference(const ReferenceOptions& options, const std::string& name,
                                  std::span<const std::byte> written) {
    Comparison c;
    c.reference = (fs::path(options.folder) / name).string();
    std::error_code unknown;
    fs::remove(difference_file(options, name), unknown);  // that of an earlier run
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
    try {
        const Measured m = measure(earlier, written, options);
        if (!m.difference) {
            c.verdict = Verdict::kOtherSize;
            return c;
        }
        c.pixels = m.pixels, c.floating = m.floating;
        c.differing_pixels = m.difference->differing_pixels;
        c.max_error = m.difference->max_error / m.unit, c.mean_error = m.difference->mean_error / m.unit;
        if (m.difference->psnr < std::numeric_limits<double>::infinity()) c.psnr = m.difference->psnr;
        c.verdict = c.differing_pixels > options.max_differing ? Verdict::kDifferent
                    : c.max_error > 0                          ? Verdict::kWithin
                                                               : Verdict::kEqual;
        if (c.verdict == Verdict::kDifferent && !is_npy(written) && !is_exr(written))
            write_difference(options, name, earlier, written, m.floating, c);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::kOutput) throw;
        c.verdict = Verdict::kUnreadable;
    }
    return c;
}

}  // namespace tessera::cli
