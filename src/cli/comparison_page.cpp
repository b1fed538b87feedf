#include "cli/comparison_page.h"

#include "cli/files.h"

#include <tessera/error.h>
#include <tessera/version.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>
#include <vector>

namespace tessera::cli {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --line: #8886; --bad: #c62828; --good: #2e7d32; }
@media (prefers-color-scheme: dark) { :root { --bad: #ff8a80; --good: #81c784; } }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 80rem; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.2rem; margin-top: 2.5rem; }
h3 { font-size: 1rem; margin: 0 0 .3rem; overflow-wrap: anywhere; }
.bad { color: var(--bad); } .good { color: var(--good); }
section, details { border-top: 1px solid var(--line); padding: 1rem 0; }
summary { cursor: pointer; font-weight: 600; }
.row { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(16rem, 100%), 1fr)); gap: 1rem; margin-top: .6rem; }
figure { margin: 0; } figcaption { font-size: .85rem; opacity: .75; }
img { max-width: 100%; height: auto; border: 1px solid var(--line);
  background: repeating-conic-gradient(#bbb 0 25%, #ddd 0 50%) 0 0 / 16px 16px; }
table { border-collapse: collapse; } td, th { padding: .15rem 1.2rem .15rem 0; text-align: left; vertical-align: top; }
code { overflow-wrap: anywhere; }
)";

std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            default:
                safe += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return safe;
}

void append_base64(std::string& text, const std::vector<std::byte>& data) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < data.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, data.size() - i);
        unsigned bits = 0;
        for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < left ? static_cast<unsigned>(data[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= left ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
    }
}

std::string shown(double value, const char* form) {
    std::array<char, 64> text;
    std::snprintf(text.data(), text.size(), form, value);
    return text.data();
}

const char* media_type(const std::vector<std::byte>& file) {
    const auto begins = [&](std::string_view magic, std::size_t from = 0) {
        return file.size() > from + magic.size() &&
               std::equal(magic.begin(), magic.end(), file.data() + from, [](char a, std::byte b) {
                   return static_cast<unsigned char>(a) == static_cast<unsigned char>(b);
               });
    };
    constexpr std::size_t kWebpMark = 8;  // after "RIFF" and a size
    if (begins("\x89PNG")) return "image/png";
    if (begins("\xff\xd8\xff")) return "image/jpeg";
    return begins("RIFF") && begins("WEBP", kWebpMark) ? "image/webp" : nullptr;
}

// What is wrong, in words.
std::string verdict_text(const Comparison& c) {
    const auto figures = [&] {
        if (c.pixels == 0) return std::string();
        const std::string unit = c.floating ? "" : "/255";
        const double share = 100 * static_cast<double>(c.differing_pixels) / static_cast<double>(c.pixels);
        std::string text = ": " + std::to_string(c.differing_pixels) + " of " + std::to_string(c.pixels) + " pixels (" +
                           shown(share, "%.3g") + " %), largest error " + shown(c.max_error, "%.4g") + unit +
                           ", mean " + shown(c.mean_error, "%.4g") + unit;
        if (c.psnr) text += ", PSNR " + shown(*c.psnr, "%.2f") + " dB";
        return text;
    };
    switch (c.verdict) {
        case Verdict::kEqual:
            return "equal";
        case Verdict::kWithin:
            return "within what is allowed" + figures();
        case Verdict::kDifferent:
            return "different" + figures();
        case Verdict::kOtherSize:
            return "another size";
        case Verdict::kUnreadable:
            return "the reference cannot be read";
        case Verdict::kMissing:
            return "there is no reference";
    }
    return "";
}

class Page {
  public:
    explicit Page(std::uint64_t max_bytes) : left_(max_bytes) {}

    void add(const std::string& text) { text_ += text; }

    void add_picture(const std::string& caption, const std::string& file) {
        text_ += "<figure>";
        std::vector<std::byte> data;
        const char* type = nullptr;
        try {
            data = read_file(file);
            type = media_type(data);
        } catch (const Error&) {
            ++unread_;  // it may be on another machine; its name is all there is to say
        }
        if (type != nullptr && data.size() <= left_) {
            left_ -= data.size();
            text_ += "<img alt=\"" + escaped(caption + " " + file) + "\" src=\"data:" + type + ";base64,";
            append_base64(text_, data);
            text_ += "\">";
        } else if (type != nullptr) {
            ++left_out_;
        }
        text_ += "<figcaption>" + escaped(caption) + ": <code>" + escaped(file) + "</code></figcaption></figure>\n";
    }

    std::uint64_t left_out() const { return left_out_; }
    std::uint64_t unread() const { return unread_; }
    std::string text() { return std::move(text_); }

  private:
    std::string text_;
    std::uint64_t left_, left_out_ = 0, unread_ = 0;
};

void add_comparison(Page& page, const PictureReport& picture) {
    const Comparison& c = *picture.comparison;
    page.add("<h3>" + escaped(picture.file) + "</h3>\n<div class=\"" + (c.failed() ? "bad" : "good") + "\">" +
             escaped(verdict_text(c)) + "</div>\n<div class=\"row\">\n");
    if (c.verdict == Verdict::kEqual) {
        page.add_picture("both", picture.file);
    } else {
        if (c.verdict != Verdict::kMissing) page.add_picture("reference", c.reference);
        page.add_picture("new", picture.file);
        if (!c.difference.empty()) page.add_picture("difference", c.difference);
    }
    page.add("</div>\n");
}

// Worst first: by kind, then by the share of pixels, then by name.
std::vector<const PictureReport*> by_severity(const BatchReport& report) {
    std::vector<const PictureReport*> pictures;
    for (const SceneReport& scene : report.scenes)
        for (const PictureReport& picture : scene.pictures)
            if (picture.comparison) pictures.push_back(&picture);
    const auto share = [](const Comparison& c) {
        return c.pixels == 0 ? 1.0 : static_cast<double>(c.differing_pixels) / static_cast<double>(c.pixels);
    };
    std::stable_sort(pictures.begin(), pictures.end(), [&](const PictureReport* a, const PictureReport* b) {
        const Comparison &x = *a->comparison, &y = *b->comparison;
        if (x.verdict != y.verdict) return x.verdict > y.verdict;
        return share(x) > share(y);
    });
    return pictures;
}

void add_head(Page& page, const BatchReport& report) {
    const BatchTotals t = totals(report);
    const bool good = exit_code(report) == kFine;
    std::string verdict = t.failed > 0 || t.differ > 0
                              ? std::to_string(t.differ) + " of " + std::to_string(t.compared) + " pictures differ"
                              : "all " + std::to_string(t.compared) + " pictures pass";
    if (t.failed > 0) verdict += ", " + std::to_string(t.failed) + (t.failed == 1 ? " scene" : " scenes") + " failed";
    page.add(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n<title>Tessera: " +
        verdict + "</title>\n<style>" + std::string(kStyle) + "</style>\n</head>\n<body>\n");
    page.add("<h1 class=\"" + std::string(good ? "good" : "bad") + "\">" + verdict + "</h1>\n<p>" +
             escaped(summary(report)) + ". Tessera " TESSERA_VERSION ".</p>\n");
    page.add("<details><summary>Options</summary>\n<table>\n");
    for (const auto& [option, value] : report.options)
        page.add("<tr><td><code>" + escaped(option) + "</code></td><td><code>" + escaped(value) +
                 "</code></td></tr>\n");
    page.add("</table></details>\n");
    if (t.failed == 0) return;
    page.add("<h2>Scenes that failed (" + std::to_string(t.failed) + ")</h2>\n<table>\n");
    for (const SceneReport& scene : report.scenes)
        if (scene.status == SceneStatus::kFailed)
            page.add("<tr><td><code>" + escaped(scene.file) + "</code></td><td>" + escaped(scene.error) +
                     "</td></tr>\n");
    page.add("</table>\n");
}

}  // namespace

std::string comparison_page(const BatchReport& report, std::uint64_t max_bytes) {
    Page page(max_bytes);
    add_head(page, report);
    const std::vector<const PictureReport*> pictures = by_severity(report);
    const auto passing =
        std::find_if(pictures.begin(), pictures.end(), [](const PictureReport* p) { return !p->comparison->failed(); });
    if (passing != pictures.begin())
        page.add("<h2>Differences (" + std::to_string(passing - pictures.begin()) + ")</h2>\n");
    for (auto p = pictures.begin(); p != passing; ++p) {
        page.add("<section>\n");
        add_comparison(page, **p);
        page.add("</section>\n");
    }
    if (passing != pictures.end()) page.add("<h2>Passes (" + std::to_string(pictures.end() - passing) + ")</h2>\n");
    for (auto p = passing; p != pictures.end(); ++p) {
        page.add("<details><summary>" + escaped((*p)->file) + "</summary>\n");
        add_comparison(page, **p);
        page.add("</details>\n");
    }
    if (page.left_out() > 0)
        page.add("<p>" + std::to_string(page.left_out()) +
                 " pictures are not in this page, which would be too large.</p>\n");
    if (page.unread() > 0)
        page.add("<p>" + std::to_string(page.unread()) + (page.unread() == 1 ? " file" : " files") +
                 " could not be read, and not shown.</p>\n");
    page.add("</body>\n</html>\n");
    return page.text();
}

}  // namespace tessera::cli
