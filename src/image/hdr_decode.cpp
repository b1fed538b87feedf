// Reading Radiance pictures ("Radiance File Formats", radsite.lbl.gov): a header of text lines, then
// scan lines of four bytes a pixel (three mantissas and a shared exponent), plain or in one of two
// run-length encodings. The header's EXPOSURE, COLORCORR and PRIMARIES are ignored: values are as stored.
#include "image/byte_cursor.h"
#include "image/codecs.h"
#include "image/rgbe.h"

#include "core/fp_environment.h"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace tessera {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::kInput, what); }

// Scan lines run along `minor`, one after the other along `major`.
struct Axis {
    bool vertical = false, descending = false;
    std::uint32_t size = 0;
};

struct Header {
    Axis major, minor;
    std::span<const std::byte> data;

    std::uint32_t width() const { return major.vertical ? minor.size : major.size; }
    std::uint32_t height() const { return major.vertical ? major.size : minor.size; }
};

std::string_view take_line(std::string_view& text) {
    constexpr std::size_t kLongestLine = 4096;
    const std::size_t end = text.substr(0, kLongestLine).find('\n');
    if (end == std::string_view::npos) fail("truncated HDR header");
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    return line.ends_with('\r') ? line.substr(0, end - 1) : line;
}

// "-Y 512": the sign tells where along the axis the picture begins; +Y begins at the bottom.
Axis take_axis(std::string_view& line) {
    if (line.size() < 4 || (line[0] != '+' && line[0] != '-') || (line[1] != 'X' && line[1] != 'Y') || line[2] != ' ')
        fail("damaged HDR: the line of the size");
    Axis axis;
    axis.vertical = line[1] == 'Y';
    axis.descending = axis.vertical == (line[0] == '+');
    line.remove_prefix(3);
    while (line.starts_with(' ')) line.remove_prefix(1);
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), axis.size);
    if (error == std::errc::result_out_of_range) axis.size = UINT32_MAX;
    if (error == std::errc::invalid_argument) fail("damaged HDR: the line of the size");
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    while (line.starts_with(' ')) line.remove_prefix(1);
    return axis;
}

Header read_header(std::span<const std::byte> file) {
    constexpr int kMostLines = 1024;
    std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    int lines = 0;
    for (std::string_view line = take_line(text); !line.empty(); line = take_line(text)) {
        if (++lines > kMostLines) fail("HDR with more than 1024 lines of header is not read");
        if (line.starts_with("FORMAT=") && line.substr(7) != "32-bit_rle_rgbe")
            fail(line.substr(7) == "32-bit_rle_xyze" ? "HDR in the XYZ colour space is not read"
                                                     : "HDR with an unknown format of pixels");
    }
    std::string_view size = take_line(text);
    Header header;
    header.major = take_axis(size);
    header.minor = take_axis(size);
    if (header.major.vertical == header.minor.vertical || !size.empty()) fail("damaged HDR: the line of the size");
    header.data = file.last(text.size());
    return header;
}

// The fewest bytes of a scan line. The old runs double their count by 8 bits with each repeated mark.
std::uint64_t least_line_bytes(std::uint64_t pixels) { return pixels == 1 ? 4 : pixels <= 256 ? 8 : 12; }

class Lines {
  public:
    explicit Lines(std::span<const std::byte> data) : data_(data) {}

    // Fills `line`, 4 bytes for each of `count` pixels.
    void read(std::uint8_t* line, std::size_t count) {
        constexpr std::size_t kLeastRun = 8, kMostRun = 0x7fff;
        const std::uint8_t* head = take(4);
        const bool runs = head[0] == 2 && head[1] == 2 && (head[2] & 0x80) == 0;
        if (!runs || count < kLeastRun || count > kMostRun) {
            data_ = rewound_;
            return read_old(line, count);
        }
        if ((static_cast<std::size_t>(head[2]) << 8 | head[3]) != count) fail("damaged HDR: length of a scan line");
        for (std::size_t channel = 0; channel < 4; ++channel) read_channel(line + channel, count);
    }

  private:
    const std::uint8_t* take(std::size_t bytes) {
        if (bytes > data_.size()) fail("damaged HDR: truncated");
        rewound_ = data_;
        const auto* taken = reinterpret_cast<const std::uint8_t*>(data_.data());
        data_ = data_.subspan(bytes);
        return taken;
    }

    // One channel of a line: up to 127 times a byte, or up to 128 bytes as they are.
    void read_channel(std::uint8_t* to, std::size_t count) {
        for (std::size_t at = 0; at < count;) {
            const std::size_t code = *take(1);
            const std::size_t length = code > 128 ? code - 128 : code;
            if (length == 0 || length > count - at) fail("damaged HDR: a run leaves its scan line");
            const std::uint8_t* from = take(code > 128 ? 1 : length);
            for (std::size_t i = 0; i < length; ++i) to[4 * (at + i)] = from[code > 128 ? 0 : i];
            at += length;
        }
    }

    // Whole pixels; (1, 1, 1, n) repeats the one before n times, and such marks in a row count by 2^8 more.
    void read_old(std::uint8_t* line, std::size_t count) {
        unsigned shift = 0;
        for (std::size_t at = 0; at < count;) {
            const std::uint8_t* pixel = take(4);
            if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
                std::copy(pixel, pixel + 4, line + 4 * at++);
                shift = 0;
                continue;
            }
            const std::size_t length = shift < 32 ? static_cast<std::size_t>(pixel[3]) << shift : 0;
            if (at == 0 || length > count - at || shift >= 32) fail("damaged HDR: a run leaves its scan line");
            for (std::size_t i = 0; i < length; ++i, ++at) std::copy(line + 4 * at - 4, line + 4 * at, line + 4 * at);
            shift += 8;
        }
    }

    std::span<const std::byte> data_, rewound_;
};

}  // namespace

bool is_hdr(std::span<const std::byte> file) { return begins_with(file, "#?"); }

ImageInfo read_hdr_info(std::span<const std::byte> file) {
    const Header header = read_header(file);
    ImageInfo info;
    info.codec = "hdr";
    info.width = static_cast<int>(std::min<std::uint32_t>(header.width(), INT32_MAX));
    info.height = static_cast<int>(std::min<std::uint32_t>(header.height(), INT32_MAX));
    info.channels = 3;
    info.bits = 32;
    info.floating = true;
    return info;
}

Image decode_hdr(std::span<const std::byte> file, std::uint64_t max_pixels) {
    const FpEnvironment environment;
    const Header header = read_header(file);
    check_image_size(header.width(), header.height(), max_pixels);
    if (header.major.size * least_line_bytes(header.minor.size) > header.data.size())
        fail("damaged HDR: too short for its size in pixels");
    Image image(static_cast<int>(header.width()), static_cast<int>(header.height()), PixelFormat::kRgba32f);
    auto* pixels = image.data<float>();
    std::vector<std::uint8_t> line(4 * std::size_t{header.minor.size});
    Lines lines(header.data);
    for (std::uint32_t i = 0; i < header.major.size; ++i) {
        lines.read(line.data(), header.minor.size);
        const std::uint32_t major = header.major.descending ? header.major.size - 1 - i : i;
        for (std::uint32_t j = 0; j < header.minor.size; ++j) {
            const std::uint32_t minor = header.minor.descending ? header.minor.size - 1 - j : j;
            const std::size_t x = header.major.vertical ? minor : major, y = header.major.vertical ? major : minor;
            rgbe_to_float(&line[4 * std::size_t{j}], pixels + 4 * (y * header.width() + x));
        }
    }
    return image;
}

}  // namespace tessera
