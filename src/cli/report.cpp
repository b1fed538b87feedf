#include "cli/report.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace tessera::cli {

namespace {

// A name of megabytes in a file must not become a line of megabytes: the middle goes, for the place
// stands at the beginning and the reason at the end. Cut between characters of UTF-8.
std::string shortened(std::string_view text) {
    constexpr std::size_t kLongest = 1000, kEnd = 300;
    if (text.size() <= kLongest) return std::string(text);
    const auto inside_character = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80; };
    std::size_t head = kLongest - kEnd, tail = text.size() - kEnd;
    while (head > 0 && inside_character(head)) --head;
    while (tail + 1 < text.size() && inside_character(tail)) ++tail;
    return std::string(text.substr(0, head)) + " ... " + std::string(text.substr(tail));
}

}  // namespace

std::string printable(std::string_view text) {
    std::string clean = shortened(text);
    for (char& c : clean)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return clean;
}

void report_error(const std::string& text) { std::fprintf(stderr, "tessera: error: %s\n", printable(text).c_str()); }

void report_warnings(const std::string& file, const std::vector<std::string>& warnings) {
    constexpr std::size_t kScreenful = 20;
    const std::size_t shown = std::min(warnings.size(), kScreenful);
    for (std::size_t i = 0; i < shown; ++i) {
        const bool named = warnings[i].compare(0, file.size(), file) == 0;
        const std::string line = named ? warnings[i] : file + ": " + warnings[i];
        std::fprintf(stderr, "tessera: warning: %s\n", printable(line).c_str());
    }
    if (warnings.size() > shown)
        std::fprintf(stderr, "tessera: warning: %s: and %zu more warnings\n", printable(file).c_str(),
                     warnings.size() - shown);
}

void report_stage(const RenderOptions& options, const RenderResult& result) {
    const auto pixels = static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
    const auto most = [&]<class T>(const T* values) { return *std::max_element(values, values + pixels); };
    if (options.show == Stage::kHiZ) {
        std::fprintf(stderr, "tessera: hiz: nearest at a reversed depth of %.9g (0 is far)\n",
                     static_cast<double>(most(result.stage.data<float>())));
        return;
    }
    const std::uint32_t count = most(result.stage.data<std::uint32_t>());
    const int side = result.stats.tile_side;
    if (options.show == Stage::kBins)
        std::fprintf(stderr, "tessera: bins: at most %u triangles in a tile of %dx%d\n", count, side, side);
    else if (options.show == Stage::kOverdraw)
        std::fprintf(stderr, "tessera: overdraw: at most %u samples tested in a pixel of %d\n", count, options.samples);
    else
        std::fprintf(stderr, "tessera: cost: at most %u cycles, estimated, in a tile of %dx%d\n", count, side, side);
}

ProgressBar::ProgressBar(bool enabled) : active_(enabled && isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::clear() {
    if (active_ && shown_percent_ >= 0) std::fputs("\r\033[K", stderr);
    shown_percent_ = -1;
}

void ProgressBar::show(double fraction) {
    const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
    if (!active_ || percent == shown_percent_) return;
    shown_percent_ = percent;
    constexpr int kWidth = 40;
    std::string bar(kWidth, ' ');
    std::fill_n(bar.begin(), percent * kWidth / 100, '=');
    std::fprintf(stderr, "\r[%s] %3d %%", bar.c_str(), percent);
    std::fflush(stderr);
}

}  // namespace tessera::cli
