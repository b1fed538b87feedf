// Writes JSON text: objects and arrays in the order of the calls, indented by two spaces, strings
// escaped (bytes that are not UTF-8 become U+FFFD), numbers in the shortest form that reads back the
// same; infinities and NaN, which JSON lacks, become null. The caller closes what it opens.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace tessera::cli {

class JsonWriter {
  public:
    JsonWriter& begin_object() { return open('{'); }
    JsonWriter& end_object() { return close('}'); }
    JsonWriter& begin_array() { return open('['); }
    JsonWriter& end_array() { return close(']'); }

    // The name of the member whose value comes next.
    JsonWriter& key(std::string_view name) {
        separate();
        quote(name);
        text_ += ": ";
        after_key_ = true;
        return *this;
    }

    JsonWriter& value(std::string_view v) {
        separate();
        quote(v);
        return *this;
    }
    JsonWriter& value(const char* v) { return value(std::string_view(v)); }
    JsonWriter& value(bool v) { return raw(v ? "true" : "false"); }
    JsonWriter& null() { return raw("null"); }

    template <class T>
    requires(std::integral<T> || std::floating_point<T>) JsonWriter& value(T v) {
        if constexpr (std::floating_point<T>)
            if (!std::isfinite(v)) return null();
        char buffer[32];
        const auto end = std::to_chars(buffer, buffer + sizeof buffer, v).ptr;
        return raw({buffer, static_cast<std::size_t>(end - buffer)});
    }

    template <class T>
    JsonWriter& member(std::string_view name, const T& v) {
        return key(name).value(v);
    }

    // The text so far, ended by a line feed.
    std::string text() const { return text_ + "\n"; }

  private:
    JsonWriter& open(char bracket) {
        separate();
        text_ += bracket;
        ++depth_;
        first_ = true;
        return *this;
    }

    JsonWriter& close(char bracket) {
        --depth_;
        if (!first_) new_line();
        text_ += bracket;
        first_ = false;
        return *this;
    }

    JsonWriter& raw(std::string_view v) {
        separate();
        text_ += v;
        return *this;
    }

    // The comma and the line break before a value or key, unless a key came just before.
    void separate() {
        if (after_key_) {
            after_key_ = false;
            return;
        }
        if (depth_ == 0) return;
        if (!first_) text_ += ',';
        first_ = false;
        new_line();
    }

    void new_line() {
        text_ += '\n';
        text_.append(2 * depth_, ' ');
    }

    // Length of the UTF-8 sequence at `at`, or 0 when it is none (RFC 3629: no overlong forms, no
    // surrogates, nothing above U+10FFFF).
    static std::size_t utf8_length(std::string_view s, std::size_t at) {
        const auto byte = [&](std::size_t i) { return i < s.size() ? static_cast<unsigned char>(s[i]) : 0u; };
        const unsigned a = byte(at), b = byte(at + 1);
        const auto tail = [](unsigned c) { return (c & 0xC0u) == 0x80u; };
        if (a < 0x80) return 1;
        if (a >= 0xC2 && a <= 0xDF) return tail(b) ? 2 : 0;
        if (a >= 0xE0 && a <= 0xEF) {
            const bool good = tail(b) && !(a == 0xE0 && b < 0xA0) && !(a == 0xED && b >= 0xA0);
            return good && tail(byte(at + 2)) ? 3 : 0;
        }
        if (a >= 0xF0 && a <= 0xF4) {
            const bool good = tail(b) && !(a == 0xF0 && b < 0x90) && !(a == 0xF4 && b >= 0x90);
            return good && tail(byte(at + 2)) && tail(byte(at + 3)) ? 4 : 0;
        }
        return 0;
    }

    void quote(std::string_view s) {
        constexpr char kHex[] = "0123456789abcdef";
        text_ += '"';
        for (std::size_t i = 0; i < s.size();) {
            const auto c = static_cast<unsigned char>(s[i]);
            const std::size_t length = utf8_length(s, i);
            if (c == '"' || c == '\\') {
                text_ += '\\';
                text_ += s[i];
            } else if (c < 0x20 || c == 0x7f) {
                text_ += "\\u00";
                text_ += kHex[c >> 4];
                text_ += kHex[c & 15];
            } else if (length == 0) {
                text_ += "\\ufffd";
            } else {
                text_ += s.substr(i, length);
            }
            i += length > 0 ? length : 1;
        }
        text_ += '"';
    }

    std::string text_;
    std::size_t depth_ = 0;
    bool first_ = true;  // nothing yet in the innermost object or array
    bool after_key_ = false;
};

}  // namespace tessera::cli
