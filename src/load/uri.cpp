#include "load/uri.h"

#include "load/base64.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

namespace tessera {
namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_ignoring_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

// RFC 3986, section 3.1: a letter, then letters, digits, "+", "-", ".", then ":".
bool has_scheme(std::string_view uri) {
    const std::size_t colon = uri.find(':');
    if (colon == std::string_view::npos || colon == 0) return false;
    const char first = lower(uri[0]);
    if (first < 'a' || first > 'z') return false;
    return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
        const char l = lower(c);
        return (l >= 'a' && l <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
    });
}

std::vector<std::string> components_of(std::string_view path) {
    std::vector<std::string> components;
    while (!path.empty()) {
        const std::size_t slash = path.find('/');
        const std::string_view part = path.substr(0, slash);
        if (!part.empty() && part != ".") components.emplace_back(part);
        if (slash == std::string_view::npos) break;
        path.remove_prefix(slash + 1);
    }
    return components;
}

// The canonical absolute path, links resolved.
std::optional<std::string> real_path(const std::string& path) {
    const std::unique_ptr<char, decltype(&std::free)> resolved(::realpath(path.c_str(), nullptr), &std::free);
    if (!resolved) return std::nullopt;
    return std::string(resolved.get());
}

[[noreturn]] void fail_with_errno(const LoadContext& context, const std::string& name, const std::string& place) {
    context.fail("\"" + name + "\": " + std::generic_category().message(errno), place);
}

// The rules for paths below the scene's folder that need no file system. `shown` stands for it in errors.
void check_name(const LoadContext& context, std::string_view path, const std::string& shown, const std::string& place) {
    if (path.empty()) context.fail("the name of a file is empty", place);
    if (path.find('\0') != std::string::npos) context.fail("\"" + shown + "\": zero character in a path", place);
    if (path.find('\\') != std::string::npos) context.fail("\"" + shown + "\": backslash in a path", place);
    if (path.front() == '/') context.fail("\"" + shown + "\": absolute paths are not read", place);
    // Decoded, it could still be read as a scheme by somebody else; here a colon is only a character.
}

void check_path(const LoadContext& context, std::string_view path, const std::string& shown, const std::string& place) {
    check_name(context, path, shown, place);
    for (const std::string& part : components_of(path))
        if (part == "..") context.fail("\"" + shown + "\": leaves the scene's folder", place);
}

// Strict base64 of what writers make of it in a URI: percent-encoded, in lines, without padding.
std::string clean_base64(const LoadContext& context, std::string_view text, const std::string& place) {
    std::string clean = percent_decode(context, text, place);
    std::erase_if(clean, [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; });
    if (clean.size() % 4 >= 2 && !clean.ends_with('=')) clean.append(4 - clean.size() % 4, '=');
    return clean;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return same_ignoring_case(uri.substr(0, 5), "data:"); }

std::string percent_decode(const LoadContext& context, std::string_view text, const std::string& place) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            decoded += text[i];
            continue;
        }
        const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
        const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
        if (high < 0 || low < 0) context.fail("broken percent escape in a URI", place);
        decoded += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return decoded;
}

// RFC 2397: data:[<mediatype>][;base64],<data>
Bytes decode_data_uri(LoadContext& context, std::string_view uri, const std::string& place) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos) context.fail("data URI without a comma", place);
    const std::string_view header = uri.substr(5, comma - 5);
    std::string_view text = uri.substr(comma + 1);
    constexpr std::string_view kBase64 = ";base64";
    if (header.size() >= kBase64.size() && same_ignoring_case(header.substr(header.size() - kBase64.size()), kBase64)) {
        std::string cleaned;
        if (text.find_first_of("% \t\r\n") != std::string_view::npos || text.size() % 4 != 0) {
            context.charge(2 * text.size(), place);
            cleaned = clean_base64(context, text, place);
            text = cleaned;
        }
        const std::optional<std::size_t> size = base64_size(text);
        if (!size) context.fail("base64 data has a wrong length", place);
        context.charge(*size, place);
        Bytes bytes(*size);
        if (!base64_decode(text, bytes.data())) context.fail("base64 data holds a wrong character", place);
        return bytes;
    }
    context.charge(text.size(), place);
    const std::string decoded = percent_decode(context, text, place);
    Bytes bytes(decoded.size());
    std::copy_n(reinterpret_cast<const std::byte*>(decoded.data()), decoded.size(), bytes.data());
    return bytes;
}

std::string checked_path(const LoadContext& context, std::string_view uri, const std::string& place) {
    const std::string shown(uri.substr(0, 200));
    if (has_scheme(uri)) context.fail("\"" + shown + "\": only relative and data: URIs are read", place);
    std::string path = percent_decode(context, uri, place);
    check_name(context, path, shown, place);
    return path;
}

std::string path_from(const LoadContext& context, const std::string& folder, const std::string& path,
                      const std::string& place) {
    const std::string shown = path.substr(0, 200);
    check_name(context, path, shown, place);
    std::vector<std::string> parts;
    for (const std::string& part : components_of(folder + "/" + path)) {
        if (part != "..") {
            parts.push_back(part);
            continue;
        }
        if (parts.empty()) context.fail("\"" + shown + "\": leaves the archive", place);
        parts.pop_back();
    }
    std::string joined;
    for (const std::string& part : parts) joined.append(joined.empty() ? "" : "/").append(part);
    return joined;
}

FileHandle open_below(const LoadContext& context, const std::string& folder, std::string_view uri,
                      const std::string& place) {
    return open_path_below(context, folder, checked_path(context, uri, place), place);
}

FileHandle open_path_below(const LoadContext& context, const std::string& folder, const std::string& path,
                           const std::string& place) {
    check_path(context, path, path.substr(0, 200), place);
    if (folder.empty()) context.fail("\"" + path + "\": a scene without a folder cannot name files", place);
    const std::optional<std::string> base = real_path(folder);
    if (!base) fail_with_errno(context, folder, place);
    const std::optional<std::string> target = real_path(folder + "/" + path);
    if (!target) fail_with_errno(context, path, place);
    const std::string prefix = *base == "/" ? *base : *base + "/";
    if (!target->starts_with(prefix)) context.fail("\"" + path + "\": leaves the scene's folder", place);

    // Links are resolved; now walk down without following any, so that nobody can swap one in.
    const std::vector<std::string> parts = components_of(std::string_view(*target).substr(prefix.size()));
    FileHandle at(::open(base->c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    for (std::size_t i = 0; i + 1 < parts.size() && at.get() >= 0; ++i)
        at = FileHandle(::openat(at.get(), parts[i].c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    struct stat status {};
    if (at.get() < 0 || parts.empty() || ::fstatat(at.get(), parts.back().c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0)
        fail_with_errno(context, path, place);
    if (!S_ISREG(status.st_mode)) context.fail("\"" + path + "\": is not a regular file", place);
    FileHandle file(
        ::openat(at.get(), parts.back().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
    if (file.get() < 0) fail_with_errno(context, path, place);
    return file;
}

}  // namespace tessera
