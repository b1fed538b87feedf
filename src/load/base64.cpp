#include "load/base64.h"

#include <array>
#include <cstdint>

namespace tessera {
namespace {

constexpr std::uint8_t kInvalid = 0x80;

constexpr std::array<std::uint8_t, 256> make_table() {
    std::array<std::uint8_t, 256> table{};
    table.fill(kInvalid);
    constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kAlphabet.size(); ++i)
        table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
    return table;
}
constexpr std::array<std::uint8_t, 256> kTable = make_table();

std::uint32_t digit(char c) { return kTable[static_cast<unsigned char>(c)]; }

std::size_t padding(std::string_view text) {
    if (text.ends_with("==")) return 2;
    return text.ends_with('=') ? 1 : 0;
}

}  // namespace

std::optional<std::size_t> base64_size(std::string_view text) {
    if (text.size() % 4 != 0) return std::nullopt;
    return text.size() / 4 * 3 - padding(text);
}

bool base64_decode(std::string_view text, std::byte* out) {
    const std::size_t pad = padding(text);
    const std::size_t whole = text.size() / 4 - (pad > 0 ? 1 : 0);
    std::uint32_t faults = 0;
    for (std::size_t i = 0; i < whole; ++i) {
        const char* c = text.data() + 4 * i;
        const std::uint32_t a = digit(c[0]), b = digit(c[1]), d = digit(c[2]), e = digit(c[3]);
        faults |= a | b | d | e;
        const std::uint32_t bits = a << 18 | b << 12 | d << 6 | e;
        out[3 * i] = static_cast<std::byte>(bits >> 16);
        out[3 * i + 1] = static_cast<std::byte>(bits >> 8);
        out[3 * i + 2] = static_cast<std::byte>(bits);
    }
    if (pad > 0) {
        const char* c = text.data() + 4 * whole;
        const std::uint32_t a = digit(c[0]), b = digit(c[1]), d = pad == 1 ? digit(c[2]) : 0;
        faults |= a | b | d;
        const std::uint32_t bits = a << 18 | b << 12 | d << 6;
        if ((bits & (pad == 1 ? 0xffu : 0xffffu)) != 0) return false;
        out[3 * whole] = static_cast<std::byte>(bits >> 16);
        if (pad == 1) out[3 * whole + 1] = static_cast<std::byte>(bits >> 8);
    }
    return (faults & kInvalid) == 0;
}

}  // namespace tessera
