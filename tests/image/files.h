// For tests of picture files: errors of calls, and what damage does to a reader.
#pragma once

#include <tessera/error.h>
#include <tessera/image_files.h>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::test {

// The error of a call, which must be one.
template <class Call>
Error error_of(const Call& call) {
    try {
        call();
    } catch (const Error& e) {
        return e;
    }
    ADD_FAILURE() << "no error";
    return {ErrorCode::kInternal, ""};
}

inline DecodeOptions keep_all(std::uint64_t max_pixels = 1u << 28) { return {max_pixels, true, true}; }

inline std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

// Where `text` begins in the file; npos when it is not in it.
inline std::size_t find_text(std::span<const std::byte> file, std::string_view text) {
    return std::string_view(reinterpret_cast<const char*>(file.data()), file.size()).find(text);
}

inline void put_little_endian(std::vector<std::byte>& file, std::size_t at, std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) file.at(at + i) = static_cast<std::byte>(value >> (8 * i) & 0xff);
}

// Decodes the file cut off at every length, and with every bit of it flipped alone. Each must give a picture
// or an error of the input (kInput, kLimit), in little memory.
inline void expect_damage_is_survived(const std::vector<std::byte>& file, std::uint64_t max_pixels = 1u << 16) {
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    const auto decode = [&](std::span<const std::byte> damaged, const std::string& what) {
        try {
            const Image image = decode_image(damaged, keep_all(max_pixels));
            const std::uint64_t pixels = image.bytes().size() / bytes_per_pixel(image.format());
            EXPECT_LE(pixels, max_pixels) << what;
        } catch (const Error& e) {
            EXPECT_TRUE(e.code() == ErrorCode::kInput || e.code() == ErrorCode::kLimit) << what << ": " << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        }
    };
    decode(file, "the whole");
    for (std::size_t length = 0; length < file.size(); ++length)
        decode(std::span(file).first(length), "the first " + std::to_string(length) + " bytes");
    std::vector<std::byte> damaged = file;
    for (std::size_t i = 0; i < file.size(); ++i) {
        for (int bit = 0; bit < 9; ++bit) {  // the ninth: all bits
            damaged[i] ^= static_cast<std::byte>(bit < 8 ? 1 << bit : 0xff);
            decode(damaged, "byte " + std::to_string(i) + ", bit " + std::to_string(bit));
            damaged[i] = file[i];
        }
    }
    ::getrusage(RUSAGE_SELF, &after);
#ifndef __SANITIZE_ADDRESS__  // which keeps what was freed
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100 * 1024) << "KiB grown";
#endif
}

}  // namespace tessera::test
