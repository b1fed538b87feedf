// Scene files written in the test, read from memory under a name.
#pragma once

#include <tessera/error.h>
#include <tessera/load.h>

#include <span>
#include <string>
#include <string_view>

namespace tessera {

inline Scene load_text(std::string_view text, const std::string& name, const LoadOptions& options = {},
                       const std::string& folder = {}) {
    return load_scene_from_memory(std::as_bytes(std::span(text.data(), text.size())), folder, options, name);
}

// The error of a file that must not load; "" when it does.
inline std::string load_error(std::string_view text, const std::string& name, const LoadOptions& options = {}) {
    try {
        load_text(text, name, options);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

}  // namespace tessera
