#include "cli/report.h"

#include <unistd.h>

#include <algorithm>
#include <cstdint>
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

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 0;  // 0: no UTF-8
};

// RFC 3629: the shortest form only, no surrogates, nothing above U+10FFFF.
Character character_at(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::uint32_t first = byte(at);
    if (first < 0x80) return {first, 1};
    const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4 || text.size() - at < bytes) return {};
    std::uint32_t code = first & (0x7fu >> bytes);
    for (std::size_t i = at + 1; i < at + bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return {};
        code = code << 6 | (byte(i) & 0x3fu);
    }
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    if (code < kLeast[bytes] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
    return {code, bytes};
}

// Controls of terminals (C0, C1), ends of lines, and what turns the direction of the text around it.
bool is_steering(std::uint32_t c) {
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x2028 || c == 0x2029 || (c >= 0x202a && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069);
}

}  // namespace

std::string printable(std::string_view text) {
    const std::string line = shortened(text);
    std::string clean;
    for (std::size_t at = 0; at < line.size();) {
        const Character c = character_at(line, at);
        if (c.bytes == 0)
            clean += "\xef\xbf\xbd";  // U+FFFD
        else if (is_steering(c.code))
            clean += ' ';
        else
            clean.append(line, at, c.bytes);
        at += std::max<std::size_t>(c.bytes, 1);
    }
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
