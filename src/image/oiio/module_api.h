// The border between the library and the OpenImageIO module (module.cpp), a shared object of its own that
// is opened on demand: Debian's OpenImageIO brings 261 shared libraries, which no start of a process
// should pay for. The module exports one symbol, `tessera_image_module`, a structure of plain functions.
// No exception crosses it, and the module allocates no pixels: the caller asks for the shape of a
// picture, checks it, and hands in the memory. Samples pass as they are stored; all conversion is the
// caller's. Functions that fail return null or 0 and leave one line in `message`.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera {

inline constexpr std::uint32_t kImageModuleVersion = 1;
inline constexpr const char* kImageModuleSymbol = "tessera_image_module";
inline constexpr const char* kImageModuleFile = "libtessera_oiio.so";
inline constexpr std::size_t kModuleMessageBytes = 256;

extern "C" {

enum ModuleFormat : std::int32_t { kModuleExr, kModuleTiff };
enum ModuleSample : std::int32_t { kModuleU8, kModuleU16, kModuleHalf, kModuleFloat, kModuleU32, kModuleOther };

struct ModuleReader;  // an open file

struct ModulePicture {
    std::int32_t width, height, channels;
    std::int32_t alpha_channel;  // -1: none
    std::int32_t straight_alpha;
};

struct ModuleOutput {
    ModuleFormat format;
    std::int32_t width, height, channels;
    const char* const* names;     // one per channel, for EXR; null: R, G, B, A
    const ModuleSample* samples;  // one per channel; all the same but in EXR
    const void* pixels;           // row by row, the channels of a pixel one after the other, no padding
};

struct ImageModule {
    std::uint32_t version;
    // Opens `file` as `format` and as nothing else; the bytes must stay until close().
    ModuleReader* (*open)(ModuleFormat format, const void* file, std::size_t size, ModulePicture* picture,
                          char* message);
    const char* (*channel_name)(const ModuleReader* reader, std::int32_t channel);
    ModuleSample (*channel_sample)(const ModuleReader* reader, std::int32_t channel);
    // The channels [first, end), row by row, the channels of a pixel one after the other; `size` is that of
    // `pixels` and must be exactly what these are.
    std::int32_t (*read)(ModuleReader* reader, std::int32_t first, std::int32_t end, void* pixels, std::size_t size,
                         char* message);
    void (*close)(ModuleReader* reader);
    // Gives the whole file to `sink`, once.
    std::int32_t (*write)(const ModuleOutput* output, void (*sink)(void* context, const void* bytes, std::size_t size),
                          void* context, char* message);
};

}  // extern "C"
}  // namespace tessera
