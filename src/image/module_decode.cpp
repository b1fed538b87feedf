// Reading EXR and TIFF through the OpenImageIO module. The header was read by us and decided what
// may be; the module gives samples as stored, which are converted here.
#include "image/codecs.h"
#include "image/exr_header.h"
#include "image/half.h"
#include "image/module.h"

#include "core/fp_environment.h"

#include <tessera/error.h>
#include <tessera/image_files.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <new>

namespace tessera {
namespace {

std::size_t bytes_of(ModuleSample sample) {
    return sample == kModuleU8 ? 1 : sample == kModuleU16 || sample == kModuleHalf ? 2 : 4;
}

// A file that the module has open.
class ModuleFile {
  public:
    // `name` is the format's, for messages.
    ModuleFile(ModuleFormat format, std::string name, std::span<const std::byte> file, const ImageInfo& info)
        : module_(require_image_module("reading " + name, false)), name_(std::move(name)) {
        reader_ = module_.open(format, file.data(), file.size(), &picture_, message_);
        if (reader_ == nullptr) fail(message_);
        if (picture_.width != info.width || picture_.height != info.height || picture_.channels < 1) {
            module_.close(reader_);
            fail("the picture has another shape than its header says");
        }
    }
    ModuleFile(const ModuleFile&) = delete;
    ModuleFile& operator=(const ModuleFile&) = delete;
    ~ModuleFile() { module_.close(reader_); }

    int channels() const { return picture_.channels; }
    int alpha_channel() const { return picture_.alpha_channel; }
    bool straight_alpha() const { return picture_.straight_alpha != 0; }
    std::size_t pixels() const {
        return static_cast<std::size_t>(picture_.width) * static_cast<std::size_t>(picture_.height);
    }
    ModuleSample sample(int channel) const { return module_.channel_sample(reader_, channel); }
    // The number of the channel, or -1.
    int find(const std::string& name) const {
        for (int c = 0; c < picture_.channels; ++c)
            if (name == module_.channel_name(reader_, c)) return c;
        return -1;
    }
    // Bytes from the start of channel `first` to that of `end` in a pixel.
    std::size_t bytes_between(int first, int end) const {
        std::size_t bytes = 0;
        for (int c = first; c < end; ++c) bytes += bytes_of(sample(c));
        return bytes;
    }
    std::unique_ptr<std::byte[]> read(int first, int end) {
        for (int c = first; c < end; ++c)
            if (sample(c) == kModuleOther) fail("samples of a kind that is not read");
        const std::size_t size = pixels() * bytes_between(first, end);
        std::unique_ptr<std::byte[]> samples(new (std::nothrow) std::byte[size]);
        if (!samples) throw Error(ErrorCode::kLimit, "not enough memory to read a picture in " + name_);
        if (module_.read(reader_, first, end, samples.get(), size, message_) == 0) fail(message_);
        return samples;
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::kInput, "the " + name_ + " cannot be read: " + what);
    }

  private:
    const ImageModule& module_;
    std::string name_;
    char message_[kModuleMessageBytes] = "";
    ModulePicture picture_{};
    ModuleReader* reader_ = nullptr;
};

template <class T>
T load(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

float load_float(const std::byte* from, ModuleSample sample) {
    switch (sample) {
        case kModuleHalf:
            return half_to_float(load<std::uint16_t>(from));
        case kModuleFloat:
            return load<float>(from);
        default:
            return static_cast<float>(load<std::uint32_t>(from));
    }
}

// Where R, G, B and A of a pixel come from: numbers of channels, -1 for an alpha of 1.
using Sources = std::array<int, 4>;

Image to_float(ModuleFile& file, const ImageInfo& info, const Sources& sources) {
    const FpEnvironment environment;
    int first = sources[0], end = sources[0] + 1;
    for (const int source : sources)
        if (source >= 0) first = std::min(first, source), end = std::max(end, source + 1);
    const std::unique_ptr<std::byte[]> samples = file.read(first, end);
    const std::size_t stride = file.bytes_between(first, end);
    Image image(info.width, info.height, PixelFormat::kRgba32f);
    for (std::size_t c = 0; c < 4; ++c) {
        float* to = image.data<float>() + c;
        const ModuleSample sample = sources[c] < 0 ? kModuleOther : file.sample(sources[c]);
        const std::byte* from = sources[c] < 0 ? nullptr : samples.get() + file.bytes_between(first, sources[c]);
        for (std::size_t i = 0, n = file.pixels(); i < n; ++i)
            to[4 * i] = from == nullptr ? 1 : load_float(from + i * stride, sample);
    }
    return image;
}

// From premultiplied to straight alpha, rounding to nearest.
template <class T>
void make_straight(T* pixel, std::uint32_t most) {
    const std::uint32_t alpha = pixel[3];
    for (int c = 0; c < 3 && alpha > 0; ++c)
        pixel[c] = static_cast<T>(std::min((pixel[c] * most + alpha / 2) / alpha, most));
}

template <class From, class To>
void to_integers(const std::byte* samples, std::size_t pixels, std::size_t channels, const Sources& sources,
                 bool straight, To* to) {
    constexpr std::uint32_t kMost = sizeof(From) == 1 ? 0xff : 0xffff;
    for (std::size_t i = 0; i < pixels; ++i, samples += channels * sizeof(From), to += 4) {
        From pixel[4];
        for (std::size_t c = 0; c < 4; ++c)
            pixel[c] = sources[c] < 0 ? static_cast<From>(kMost)
                                      : load<From>(samples + static_cast<std::size_t>(sources[c]) * sizeof(From));
        if (!straight) make_straight(pixel, kMost);
        for (std::size_t c = 0; c < 4; ++c)
            to[c] = sizeof(From) == sizeof(To) ? static_cast<To>(pixel[c])
                                               : static_cast<To>((pixel[c] * 255u + 32767) / 65535);
    }
}

Image to_integers(ModuleFile& file, const ImageInfo& info, const Sources& sources, bool keep_16_bit) {
    const ModuleSample sample = file.sample(0);
    if (sample != kModuleU8 && sample != kModuleU16) file.fail("samples of a kind that is not read");
    const std::unique_ptr<std::byte[]> samples = file.read(0, file.channels());
    const auto channels = static_cast<std::size_t>(file.channels());
    const bool wide = sample == kModuleU16 && keep_16_bit, straight = sources[3] < 0 || file.straight_alpha();
    Image image(info.width, info.height, wide ? PixelFormat::kRgba16 : PixelFormat::kRgba8);
    auto* bytes = image.data<std::uint8_t>();
    if (sample == kModuleU8)
        to_integers<std::uint8_t>(samples.get(), file.pixels(), channels, sources, straight, bytes);
    else if (wide)
        to_integers<std::uint16_t>(samples.get(), file.pixels(), channels, sources, straight,
                                   image.data<std::uint16_t>());
    else
        to_integers<std::uint16_t>(samples.get(), file.pixels(), channels, sources, straight, bytes);
    return image;
}

// Grey, grey and alpha, RGB, RGBA; what comes after is left out.
Sources sources_of(const ModuleFile& file) {
    Sources sources = file.channels() < 3 ? Sources{0, 0, 0, -1} : Sources{0, 1, 2, -1};
    const int colors = file.channels() < 3 ? 1 : 3;
    if (file.alpha_channel() >= colors) sources[3] = file.alpha_channel();
    return sources;
}

}  // namespace

Image decode_exr(std::span<const std::byte> file, std::uint64_t max_pixels) {
    const ExrHeader header = read_exr_header(file);
    check_image_size(header.width, header.height, max_pixels);
    const ImageInfo info = read_exr_info(file);
    const bool color = header.find("R") != nullptr && header.find("G") != nullptr && header.find("B") != nullptr;
    if (!color && header.find("Y") == nullptr)
        throw Error(ErrorCode::kInput, "the EXR has neither the channels R, G, B nor Y");
    ModuleFile opened(kModuleExr, "EXR", file, info);
    Sources sources{opened.find(color ? "R" : "Y"), opened.find(color ? "G" : "Y"), opened.find(color ? "B" : "Y"),
                    opened.find("A")};
    if (*std::min_element(sources.begin(), sources.begin() + 3) < 0) opened.fail("channels");
    return to_float(opened, info, sources);
}

std::vector<ImagePlane> decode_exr_channels(std::span<const std::byte> file, std::uint64_t max_pixels) {
    if (!is_exr(file)) throw Error(ErrorCode::kInput, "not an EXR file");
    const ExrHeader header = read_exr_header(file);
    check_image_size(header.width, header.height, max_pixels);
    const ImageInfo info = read_exr_info(file);
    const std::uint64_t samples = std::uint64_t{header.width} * header.height * header.channels.size();
    if (samples / 4 > max_pixels)
        throw Error(ErrorCode::kLimit, std::to_string(header.channels.size()) + " channels of " +
                                           std::to_string(header.width) + " x " + std::to_string(header.height) +
                                           " pixels exceed 4 times the limit of " + std::to_string(max_pixels));
    ModuleFile opened(kModuleExr, "EXR", file, info);
    std::vector<ImagePlane> planes;
    const std::unique_ptr<std::byte[]> pixels = opened.read(0, opened.channels());
    const std::size_t stride = opened.bytes_between(0, opened.channels());
    for (const ExrHeader::Channel& channel : header.channels) {
        const int number = opened.find(channel.name);
        if (number < 0) opened.fail("channels");
        const bool whole = channel.type == ChannelType::kUint;
        const ModuleSample sample = opened.sample(number);
        if (whole != (sample == kModuleU32)) opened.fail("types of channels");
        ImagePlane plane{channel.name, channel.type,
                         Image(info.width, info.height, whole ? PixelFormat::kU32 : PixelFormat::kF32)};
        const std::byte* from = pixels.get() + opened.bytes_between(0, number);
        for (std::size_t i = 0, n = opened.pixels(); i < n; ++i, from += stride) {
            if (whole)
                plane.pixels.data<std::uint32_t>()[i] = load<std::uint32_t>(from);
            else
                plane.pixels.data<float>()[i] = load_float(from, sample);
        }
        planes.push_back(std::move(plane));
    }
    return planes;
}

Image decode_tiff(std::span<const std::byte> file, std::uint64_t max_pixels, bool keep_16_bit) {
    const ImageInfo info = read_tiff_info(file);
    check_image_size(static_cast<std::uint64_t>(info.width), static_cast<std::uint64_t>(info.height), max_pixels);
    ModuleFile opened(kModuleTiff, "TIFF", file, info);
    const Sources sources = sources_of(opened);
    return info.floating ? to_float(opened, info, sources) : to_integers(opened, info, sources, keep_16_bit);
}

}  // namespace tessera
