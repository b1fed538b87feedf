#include "load/text.h"

#include <charconv>
#include <limits>

namespace tessera {

bool TextCursor::next_line() {
    if (!started_) {
        started_ = true;
        line_ = 1;
        return !text_.empty();
    }
    while (!word().empty()) {
    }
    at_ = offset_after_line();
    ++line_;
    return at_ < text_.size();
}

std::size_t TextCursor::offset_after_line() const {
    std::size_t at = at_;
    while (!at_line_end(at)) ++at;
    const std::string_view end = text_.substr(at, 2);
    return at + (end == "\r\n" ? 2 : end.empty() ? 0 : 1);
}

bool TextCursor::skip_blanks() {
    for (;;) {
        if (at_line_end(at_)) return false;
        const char c = text_[at_];
        if (c == ' ' || c == '\t' || c == '\v' || c == '\f') {
            ++at_;
        } else if (joins_ && c == '\\' && at_ + 1 < text_.size() && at_line_end(at_ + 1)) {
            at_ += text_[at_ + 1] == '\r' && at_ + 2 < text_.size() && text_[at_ + 2] == '\n' ? 3 : 2;
            ++line_;
        } else {
            return true;
        }
    }
}

std::string_view TextCursor::word() {
    if (!skip_blanks()) return {};
    const std::size_t first = at_;
    while (!at_line_end(at_)) {
        const char c = text_[at_];
        if (c == ' ' || c == '\t' || c == '\v' || c == '\f') break;
        if (joins_ && c == '\\' && at_ > first && at_ + 1 < text_.size() && at_line_end(at_ + 1)) break;
        ++at_;
    }
    return text_.substr(first, at_ - first);
}

std::string_view TextCursor::rest() {
    if (!skip_blanks()) return {};
    const std::size_t first = at_;
    while (!at_line_end(at_)) ++at_;
    std::string_view words = text_.substr(first, at_ - first);
    while (!words.empty() && (words.back() == ' ' || words.back() == '\t')) words.remove_suffix(1);
    return words;
}

namespace {

template <class T, class... Format>
std::from_chars_result parse_whole(std::string_view word, T& value) {
    // from_chars takes no plus sign.
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    std::from_chars_result result = std::from_chars(word.data(), word.data() + word.size(), value);
    // Also behind a number that is out of range.
    if (result.ptr != word.data() + word.size()) result.ec = std::errc::invalid_argument;
    return result;
}

}  // namespace

std::optional<double> parse_double(std::string_view word) {
    double value = 0;
    const auto [end, error] = parse_whole(word, value);
    if (error == std::errc::result_out_of_range) {
        const bool negative = word[0] == '-';
        const char first = word[negative || word[0] == '+' ? 1 : 0];
        const bool tiny = first == '0' || first == '.' || word.find("e-") != word.npos || word.find("E-") != word.npos;
        value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
        return negative ? -value : value;
    }
    if (error != std::errc()) return std::nullopt;
    return value;
}

std::optional<float> parse_float(std::string_view word) {
    float value = 0;
    const auto [end, error] = parse_whole(word, value);
    if (error == std::errc::result_out_of_range) {
        // Beyond floats, which doubles say more exactly: infinite, or below the least float.
        return static_cast<float>(*parse_double(word));
    }
    if (error != std::errc()) return std::nullopt;
    return value;
}

std::optional<long long> parse_integer(std::string_view word) {
    long long value = 0;
    const auto [end, error] = parse_whole(word, value);
    if (error != std::errc()) return std::nullopt;
    return value;
}

std::string quoted(std::string_view word) {
    std::string text = "\"";
    text.append(word.substr(0, 60));
    text.push_back('"');
    return text;
}

}  // namespace tessera
