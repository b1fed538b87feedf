// Names of output files with places to fill in: "{model}_{frame:04}.png". `{{` and `}}` are braces.
#pragma once

#include <map>
#include <string>
#include <variant>

namespace tessera::cli {

// Texts, and numbers, which may be asked for with a width: {frame:04} has four digits at least.
using PatternValues = std::map<std::string, std::variant<std::string, long>>;

// `name` as a part of a file name: without slashes and control characters, and never "." or "..".
std::string safe_name(const std::string& name);

// Whether the pattern has a place of that name.
bool has_place(const std::string& pattern, const std::string& name);
// Throws kUsage, naming the option, for places that have no value and for what is no place at all.
std::string fill_pattern(const std::string& option, const std::string& pattern, const PatternValues& values);

}  // namespace tessera::cli
