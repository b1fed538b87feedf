// Base64 (RFC 4648, section 4), strict: the standard alphabet, padding required, no white space, the
// unused bits of the last character zero.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace tessera {

// The number of bytes that `text` encodes, if its length and padding are valid.
std::optional<std::size_t> base64_size(std::string_view text);
// Writes base64_size(text) bytes to `out`; false when a character is not of the alphabet.
bool base64_decode(std::string_view text, std::byte* out);

}  // namespace tessera
