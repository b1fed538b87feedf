#include "cli/pattern.h"

#include "cli/parse.h"

#include <algorithm>

namespace tessera::cli {
namespace {

// "04" or "4": zeros in front, at least so many digits.
std::string padded(const std::string& option, long number, const std::string& width) {
    if (!width.empty() &&
        (width.size() > 3 || !std::all_of(width.begin(), width.end(), [](char c) { return c >= '0' && c <= '9'; })))
        refuse(option, "'" + width + "' is no width of a number");
    std::string digits = std::to_string(number < 0 ? -number : number);
    const std::size_t wanted = width.empty() ? 0 : static_cast<std::size_t>(std::stoi(width));
    if (digits.size() < wanted) digits.insert(0, wanted - digits.size(), '0');
    return (number < 0 ? "-" : "") + digits;
}

}  // namespace

std::string safe_name(const std::string& name) {
    std::string safe = name;
    for (char& c : safe)
        if (c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
    return safe.empty() || safe == "." || safe == ".." ? "_" : safe;
}

bool has_place(const std::string& pattern, const std::string& name) {
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        if (pattern[i] != '{') continue;
        if (pattern.compare(i, 2, "{{") == 0) {
            ++i;
        } else if (pattern.compare(i + 1, name.size(), name) == 0) {
            const std::size_t end = i + 1 + name.size();
            if (end < pattern.size() && (pattern[end] == '}' || pattern[end] == ':')) return true;
        }
    }
    return false;
}

std::string fill_pattern(const std::string& option, const std::string& pattern, const PatternValues& values) {
    std::string filled;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        const char c = pattern[i];
        if ((c == '{' || c == '}') && i + 1 < pattern.size() && pattern[i + 1] == c) {
            filled += c;
            ++i;
        } else if (c == '}') {
            refuse(option, "a } without its {");
        } else if (c != '{') {
            filled += c;
        } else {
            const std::size_t end = pattern.find('}', i);
            if (end == std::string::npos) refuse(option, "a { without its }");
            const std::string place = pattern.substr(i + 1, end - i - 1);
            const std::size_t colon = place.find(':');
            const auto value = values.find(place.substr(0, colon));
            if (value == values.end()) {
                std::string names;
                for (const auto& [name, unused] : values) names += (names.empty() ? "" : ", ") + ("{" + name + "}");
                refuse(option, "{" + place + "} is no place to fill in; there are: " + names);
            }
            const std::string width = colon == std::string::npos ? "" : place.substr(colon + 1);
            if (const long* number = std::get_if<long>(&value->second))
                filled += padded(option, *number, width);
            else if (colon != std::string::npos)
                refuse(option, "{" + place + "}: only numbers have a width");
            else
                filled += std::get<std::string>(value->second);
            i = end;
        }
    }
    return filled;
}

}  // namespace tessera::cli
