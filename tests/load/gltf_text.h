// Small glTF documents for tests: a buffer that grows, and the JSON around it.
#pragma once

#include <tessera/error.h>
#include <tessera/load.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace tessera {

inline std::string to_base64(const std::vector<std::uint8_t>& bytes) {
    static constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kAlphabet[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

// The bytes of values, little-endian.
template <class T>
std::vector<std::uint8_t> bytes_of(const std::vector<T>& values) {
    std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

// {"asset":..., <members>, "buffers":[one data URI]}
inline std::string gltf_text(const std::string& members, const std::vector<std::uint8_t>& buffer = {}) {
    std::string text = "{\"asset\":{\"version\":\"2.0\"}";
    if (!members.empty()) text += "," + members;
    if (!buffer.empty())
        text += ",\"buffers\":[{\"byteLength\":" + std::to_string(buffer.size()) +
                ",\"uri\":\"data:application/octet-stream;base64," + to_base64(buffer) + "\"}]";
    return text + "}";
}

inline std::span<const std::byte> as_file(const std::string& text) {
    return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

inline Scene load_text(const std::string& text, const LoadOptions& options = {}) {
    const Scene scene = load_scene_from_memory(as_file(text), "", options, "test.gltf");
    EXPECT_NO_THROW(validate(scene));
    return scene;
}

// The error's one line; "" when the text loads.
inline std::string load_error(const std::string& text, const LoadOptions& options = {},
                              ErrorCode expected = ErrorCode::kInput) {
    try {
        load_scene_from_memory(as_file(text), "", options, "test.gltf");
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), expected) << error.what();
        return error.what();
    }
    return {};
}

// Whether some warning holds `part`.
inline bool warned(const Scene& scene, const std::string& part) {
    for (const std::string& warning : scene.warnings)
        if (warning.find(part) != std::string::npos) return true;
    return false;
}

}  // namespace tessera
