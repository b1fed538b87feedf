// NumPy's array format (numpy.lib.format): magic, version, the length of a header, the header as a Python
// dictionary of three keys, the values. Written: version 1.0. Read: 1.0, 2.0 (a longer length) and 3.0 (UTF-8 in
// the header), of two or three dimensions. The header is parsed strictly: what is not understood is refused.
#include "image/codecs.h"

#include <tessera/error.h>
#include <tessera/planes.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr std::string_view kMagic{"\x93NUMPY"};
constexpr std::size_t kAlignment = 64;           // of the values in the file
constexpr std::size_t kLongestHeader = 1 << 16;  // NumPy's own of such arrays have 118 bytes
constexpr int kMaxComponents = 64;

// By NpyType.
constexpr std::array<std::string_view, 5> kNames{"|u1", "<u2", "<u4", "<f2", "<f4"};
constexpr std::array<std::size_t, 5> kSizes{1, 2, 4, 2, 4};

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::kInput, "NumPy array: " + why); }

// The words of the header: Python literals of the kinds that the three keys need.
class HeaderText {
  public:
    explicit HeaderText(std::string_view text) : rest_(text) {}

    bool accept(std::string_view token) {
        skip_blanks();
        if (!rest_.starts_with(token)) return false;
        rest_.remove_prefix(token.size());
        return true;
    }
    void expect(std::string_view token) {
        if (!accept(token)) refuse("damaged header");
    }
    std::string_view string() {
        skip_blanks();
        const char quote = rest_.empty() ? '\0' : rest_.front();
        if (quote != '\'' && quote != '"') refuse("damaged header");
        const std::size_t end = rest_.find(quote, 1);
        if (end == std::string_view::npos || rest_.find('\\') < end) refuse("damaged header");
        const std::string_view content = rest_.substr(1, end - 1);
        rest_.remove_prefix(end + 1);
        return content;
    }
    std::uint64_t number() {
        skip_blanks();
        std::uint64_t value = 0;
        std::size_t digits = 0;
        for (; digits < rest_.size() && rest_[digits] >= '0' && rest_[digits] <= '9'; ++digits) {
            if (digits == 9) throw Error(ErrorCode::kLimit, "NumPy array: a side of 10^9 or more");
            value = 10 * value + static_cast<std::uint64_t>(rest_[digits] - '0');
        }
        if (digits == 0) refuse("damaged header");
        rest_.remove_prefix(digits);
        return value;
    }
    bool at_end() {
        skip_blanks();
        return rest_.empty();
    }

  private:
    void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \n"), rest_.size())); }
    std::string_view rest_;
};

NpyType parse_type(std::string_view descr) {
    for (std::size_t i = 0; i < kNames.size(); ++i)
        if (descr == kNames[i]) return static_cast<NpyType>(i);
    // Only what a type can look like is repeated.
    const bool plain = descr.size() <= 8 && descr.find_first_not_of("<>|=0123456789abcdefghijklmnopqrstuvwxyzMOSUV") ==
                                                std::string_view::npos;
    refuse("values of type " + (plain ? std::string(descr) : std::string("unknown")) +
           "; |u1, <u2, <u4, <f2 and <f4 can be read");
}

struct Shape {
    std::array<std::uint64_t, 3> sides{0, 0, 1};  // height, width, components
};

Shape parse_shape(HeaderText& text) {
    Shape shape;
    std::size_t count = 0;
    text.expect("(");
    while (!text.accept(")")) {
        if (count == 3) refuse("more than 3 dimensions; (height, width) or (height, width, components) is read");
        shape.sides[count++] = text.number();
        if (text.accept(")")) break;
        text.expect(",");
    }
    if (count < 2)
        refuse(std::to_string(count) + " dimensions; (height, width) or (height, width, components) is read");
    return shape;
}

struct Header {
    NpyType type = NpyType::kU1;
    Shape shape;
};

Header parse_header(std::string_view content) {
    HeaderText text(content);
    Header header;
    bool has_type = false, has_order = false, has_shape = false;
    const auto once = [](bool& seen) {
        if (seen) refuse("damaged header");
        seen = true;
    };
    text.expect("{");
    while (!text.accept("}")) {
        const std::string_view key = text.string();
        text.expect(":");
        if (key == "descr") {
            once(has_type);
            header.type = parse_type(text.string());
        } else if (key == "fortran_order") {
            once(has_order);
            if (text.accept("True")) refuse("Fortran order; C order is read");
            text.expect("False");
        } else if (key == "shape") {
            once(has_shape);
            header.shape = parse_shape(text);
        } else {
            refuse("damaged header");
        }
        if (text.accept("}")) break;
        text.expect(",");
    }
    if (!has_type || !has_order || !has_shape || !text.at_end()) refuse("damaged header");
    return header;
}

// Where the header begins in the file, and its length.
std::span<const std::byte> find_header(std::span<const std::byte> file) {
    if (!is_npy(file)) throw Error(ErrorCode::kInput, "not a NumPy array");
    if (file.size() < 12) refuse("truncated");
    const auto major = static_cast<unsigned>(file[6]), minor = static_cast<unsigned>(file[7]);
    if (major < 1 || major > 3 || minor != 0)
        refuse("version " + std::to_string(major) + "." + std::to_string(minor) + "; 1.0, 2.0 and 3.0 can be read");
    const std::size_t begin = major == 1 ? 10 : 12;
    std::size_t length = 0;
    for (std::size_t i = begin; i-- > 8;) length = length << 8 | static_cast<std::size_t>(file[i]);
    if (length > kLongestHeader) refuse("a header of " + std::to_string(length) + " bytes");
    if (length > file.size() - begin) refuse("truncated");
    return file.subspan(begin, length);
}

}  // namespace

std::size_t bytes_per_value(NpyType type) {
    const auto i = static_cast<std::size_t>(type);
    if (i >= kSizes.size()) throw Error(ErrorCode::kUsage, "unknown type of values");
    return kSizes[i];
}

const char* name(NpyType type) {
    bytes_per_value(type);  // refuses what is none
    return kNames[static_cast<std::size_t>(type)].data();
}

bool is_npy(std::span<const std::byte> file) {
    return file.size() >= kMagic.size() && std::memcmp(file.data(), kMagic.data(), kMagic.size()) == 0;
}

std::vector<std::byte> encode_npy(int width, int height, int components, NpyType type, const void* values) {
    const std::size_t value_bytes = bytes_per_value(type);
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide || components < 1 ||
        components > kMaxComponents)
        throw Error(ErrorCode::kUsage, "an array of " + std::to_string(height) + " x " + std::to_string(width) + " x " +
                                           std::to_string(components));
    std::string header(kMagic);
    header += std::string_view("\x01\0\0\0", 4);  // version, length
    header.append("{'descr': '").append(kNames[static_cast<std::size_t>(type)]);
    header.append("', 'fortran_order': False, 'shape': (").append(std::to_string(height)).append(", ");
    header += std::to_string(width);
    if (components > 1) header.append(", ").append(std::to_string(components));
    header += "), }";
    // Blanks and a line feed, so that the values begin at a multiple of the alignment.
    header.append(kAlignment - 1 - header.size() % kAlignment, ' ');
    header += '\n';
    const std::size_t length = header.size() - 10;
    header[8] = static_cast<char>(length & 0xff), header[9] = static_cast<char>(length >> 8);

    const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                              static_cast<std::size_t>(components) * value_bytes;
    std::vector<std::byte> file(header.size() + bytes);
    std::memcpy(file.data(), header.data(), header.size());
    std::memcpy(file.data() + header.size(), values, bytes);
    return file;
}

std::vector<std::byte> encode_npy(const Image& image) {
    if (image.empty()) throw Error(ErrorCode::kUsage, "an empty image cannot be written");
    const auto encode = [&](int components, NpyType type) {
        return encode_npy(image.width(), image.height(), components, type, image.bytes().data());
    };
    switch (image.format()) {
        case PixelFormat::kRgba8:
            return encode(4, NpyType::kU1);
        case PixelFormat::kRgba16:
            return encode(4, NpyType::kU2);
        case PixelFormat::kRgba32f:
            return encode(4, NpyType::kF4);
        case PixelFormat::kF32:
            return encode(1, NpyType::kF4);
        case PixelFormat::kRg32f:
            return encode(2, NpyType::kF4);
        case PixelFormat::kRgb32f:
            return encode(3, NpyType::kF4);
        case PixelFormat::kU32:
            return encode(1, NpyType::kU4);
    }
    throw Error(ErrorCode::kUsage, "unknown pixel format");
}

NpyArray decode_npy(std::span<const std::byte> file, std::uint64_t max_pixels) {
    const std::span<const std::byte> text = find_header(file);
    const Header header = parse_header({reinterpret_cast<const char*>(text.data()), text.size()});
    const auto [height, width, components] = header.shape.sides;
    check_image_size(width, height, max_pixels);
    if (components < 1 || components > kMaxComponents)
        refuse(std::to_string(components) + " components; 1 to " + std::to_string(kMaxComponents) + " can be read");

    const std::span<const std::byte> values =
        file.subspan(static_cast<std::size_t>(text.data() - file.data()) + text.size());
    const std::uint64_t expected = width * height * components * bytes_per_value(header.type);
    if (values.size() != expected)
        refuse(std::to_string(values.size()) + " bytes of values instead of " + std::to_string(expected));
    NpyArray array;
    array.width = static_cast<int>(width), array.height = static_cast<int>(height);
    array.components = static_cast<int>(components);
    array.type = header.type;
    array.values.assign(values.begin(), values.end());
    return array;
}

}  // namespace tessera
