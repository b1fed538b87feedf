// Reading numbers from a file's header in memory, in either order of bytes. Every read is checked: past
// the end it throws kInput with "truncated NAME header".
#pragma once

#include <tessera/error.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tessera {

class ByteCursor {
  public:
    ByteCursor(std::span<const std::byte> file, std::string name, bool big_endian = false)
        : file_(file), name_(std::move(name)), big_endian_(big_endian) {}

    std::size_t position() const { return at_; }
    std::size_t rest() const { return file_.size() - at_; }
    void set_big_endian(bool big_endian) { big_endian_ = big_endian; }
    void seek(std::uint64_t position) {
        if (position > file_.size()) fail();
        at_ = static_cast<std::size_t>(position);
    }
    void skip(std::uint64_t bytes) {
        if (bytes > rest()) fail();
        at_ += static_cast<std::size_t>(bytes);
    }
    // A number of 1 to 8 bytes.
    std::uint64_t number(std::size_t bytes) {
        if (bytes > rest()) fail();
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i) {
            const std::size_t from = big_endian_ ? i : bytes - 1 - i;
            value = value << 8 | static_cast<std::uint64_t>(file_[at_ + from]);
        }
        at_ += bytes;
        return value;
    }
    std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
    std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
    // Text up to a zero byte, of at most `most` bytes.
    std::string_view text(std::size_t most) {
        const auto* begin = reinterpret_cast<const char*>(file_.data()) + at_;
        const std::string_view there(begin, rest() < most + 1 ? rest() : most + 1);
        const std::size_t length = there.find('\0');
        if (length == std::string_view::npos) fail();
        at_ += length + 1;
        return there.substr(0, length);
    }
    bool begins_with(std::string_view magic) const {
        return std::string_view(reinterpret_cast<const char*>(file_.data()) + at_, rest()).starts_with(magic);
    }

  private:
    [[noreturn]] void fail() const { throw Error(ErrorCode::kInput, "truncated " + name_ + " header"); }

    std::span<const std::byte> file_;
    std::string name_;
    std::size_t at_ = 0;
    bool big_endian_;
};

inline bool begins_with(std::span<const std::byte> file, std::string_view magic) {
    return ByteCursor(file, "").begins_with(magic);
}

}  // namespace tessera
