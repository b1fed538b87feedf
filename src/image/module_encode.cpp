// Writing EXR and TIFF through the OpenImageIO module, which takes samples as they are stored.
#include "image/codecs.h"
#include "image/half.h"
#include "image/module.h"

#include "core/fp_environment.h"

#include <tessera/error.h>
#include <tessera/image_files.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

namespace tessera {
namespace {

std::unique_ptr<std::byte[]> memory_for(std::size_t bytes) {
    std::unique_ptr<std::byte[]> memory(new (std::nothrow) std::byte[bytes]);
    if (!memory) throw Error(ErrorCode::kLimit, "not enough memory to write a picture");
    return memory;
}

std::vector<std::byte> write(const std::string& name, const ModuleOutput& output) {
    const ImageModule& module = require_image_module("writing " + name, true);
    std::vector<std::byte> file;
    struct Sink {
        std::vector<std::byte>& file;
        bool memory_ended = false;
    } sink{file};
    const auto take = [](void* context, const void* bytes, std::size_t size) {
        auto& to = *static_cast<Sink*>(context);
        const auto* begin = static_cast<const std::byte*>(bytes);
        try {
            to.file.assign(begin, begin + size);
        } catch (const std::bad_alloc&) {
            to.memory_ended = true;
        }
    };
    char message[kModuleMessageBytes] = "";
    if (module.write(&output, take, &sink, message) == 0)
        throw Error(ErrorCode::kOutput, "cannot write " + name + ": " + message);
    if (sink.memory_ended) throw Error(ErrorCode::kLimit, "not enough memory to write a picture");
    return file;
}

void check_channels(int width, int height, std::span<const ImageChannel> channels) {
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)
        throw Error(ErrorCode::kUsage, "EXR of " + std::to_string(width) + " x " + std::to_string(height) +
                                           " pixels: each side must be 1 to " + std::to_string(kMaxImageSide));
    constexpr std::size_t kMostChannels = 1024, kLongestName = 255;
    if (channels.empty() || channels.size() > kMostChannels)
        throw Error(ErrorCode::kUsage, "EXR takes 1 to 1024 channels, not " + std::to_string(channels.size()));
    std::vector<std::string> names;
    for (const ImageChannel& channel : channels) {
        if (channel.name.empty() || channel.name.size() > kLongestName || channel.name.find('\0') != std::string::npos)
            throw Error(ErrorCode::kUsage, "the name of a channel of EXR must have 1 to 255 bytes, none of them 0");
        if (channel.pixels == nullptr) throw Error(ErrorCode::kUsage, "a channel of EXR has no pixels");
        names.push_back(channel.name);
    }
    std::sort(names.begin(), names.end());
    if (const auto same = std::adjacent_find(names.begin(), names.end()); same != names.end())
        throw Error(ErrorCode::kUsage, "two channels of EXR are named " + *same);
}

void pack_channel(const ImageChannel& channel, std::size_t count, std::size_t stride, std::byte* to) {
    const auto* from = static_cast<const std::byte*>(channel.pixels);
    for (std::size_t i = 0; i < count; ++i, from += channel.pixel_stride, to += stride) {
        if (channel.type != ChannelType::kHalf) {
            std::memcpy(to, from, 4);
            continue;
        }
        float value;
        std::memcpy(&value, from, sizeof value);
        const std::uint16_t half = float_to_half(value);
        std::memcpy(to, &half, sizeof half);
    }
}

template <class T>
bool is_opaque(const Image& image, T full) {
    const T* samples = image.data<T>();
    for (std::size_t i = 3, n = image.bytes().size() / sizeof(T); i < n; i += 4)
        if (samples[i] != full) return false;
    return true;
}

// The image without its alpha.
std::unique_ptr<std::byte[]> without_alpha(const Image& image) {
    const std::size_t bytes = bytes_per_pixel(image.format());
    const std::size_t pixels = image.bytes().size() / bytes;
    std::unique_ptr<std::byte[]> packed = memory_for(pixels * bytes / 4 * 3);
    for (std::size_t i = 0; i < pixels; ++i)
        std::memcpy(packed.get() + i * bytes / 4 * 3, image.bytes().data() + i * bytes, bytes / 4 * 3);
    return packed;
}

}  // namespace

std::vector<std::byte> encode_exr(int width, int height, std::span<const ImageChannel> channels) {
    check_channels(width, height, channels);
    std::vector<const char*> names;
    std::vector<ModuleSample> samples;
    std::size_t stride = 0;
    for (const ImageChannel& channel : channels) {
        names.push_back(channel.name.c_str());
        samples.push_back(channel.type == ChannelType::kHalf    ? kModuleHalf
                          : channel.type == ChannelType::kFloat ? kModuleFloat
                                                                : kModuleU32);
        stride += channel.type == ChannelType::kHalf ? 2 : 4;
    }
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const std::unique_ptr<std::byte[]> pixels = memory_for(count * stride);
    std::byte* to = pixels.get();
    for (const ImageChannel& channel : channels) {
        pack_channel(channel, count, stride, to);
        to += channel.type == ChannelType::kHalf ? 2 : 4;
    }
    return write("EXR", {kModuleExr, width, height, static_cast<std::int32_t>(channels.size()), names.data(),
                         samples.data(), pixels.get()});
}

std::vector<std::byte> encode_tiff(const Image& image) {
    bool opaque = false;
    switch (image.empty() ? PixelFormat::kU32 : image.format()) {
        case PixelFormat::kRgba8:
            opaque = is_opaque<std::uint8_t>(image, 0xff);
            break;
        case PixelFormat::kRgba16:
            opaque = is_opaque<std::uint16_t>(image, 0xffff);
            break;
        case PixelFormat::kRgba32f:
            opaque = is_opaque<float>(image, 1);
            break;
        default:
            throw Error(ErrorCode::kUsage, "TIFF takes images of RGBA");
    }
    const ModuleSample sample = image.format() == PixelFormat::kRgba8    ? kModuleU8
                                : image.format() == PixelFormat::kRgba16 ? kModuleU16
                                                                         : kModuleFloat;
    const ModuleSample samples[] = {sample, sample, sample, sample};
    const std::unique_ptr<std::byte[]> packed = opaque ? without_alpha(image) : nullptr;
    const void* pixels = opaque ? packed.get() : image.bytes().data();
    return write("TIFF", {kModuleTiff, image.width(), image.height(), opaque ? 3 : 4, nullptr, samples, pixels});
}

}  // namespace tessera
