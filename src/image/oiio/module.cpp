// The OpenImageIO module. Formats are chosen by the caller from a list; OpenImageIO's own guessing, by
// name or by content, is never asked.
#include "image/oiio/module_api.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tessera {

// A file in memory. OpenImageIO's own reader of memory trusts offsets, which come from the file.
class MemoryFile final : public OIIO::Filesystem::IOProxy {
  public:
    MemoryFile(const void* bytes, std::size_t size)
        : IOProxy("", Read), bytes_(static_cast<const char*>(bytes)), size_(size) {}
    const char* proxytype() const override { return "memory"; }
    std::size_t size() const override { return size_; }
    bool seek(std::int64_t offset) override {
        if (offset < 0) return false;
        m_pos = offset;
        return true;
    }
    std::size_t read(void* to, std::size_t count) override {
        const std::size_t got = pread(to, count, m_pos);
        m_pos += static_cast<std::int64_t>(got);
        return got;
    }
    std::size_t pread(void* to, std::size_t count, std::int64_t offset) override {
        if (offset < 0 || static_cast<std::uint64_t>(offset) >= size_) return 0;
        const std::size_t got = std::min(count, size_ - static_cast<std::size_t>(offset));
        std::memcpy(to, bytes_ + offset, got);
        return got;
    }

  private:
    const char* bytes_;
    std::size_t size_;
};

struct ModuleReader {
    MemoryFile file;  // outlives the input
    std::unique_ptr<OIIO::ImageInput> input;

    ModuleReader(const void* bytes, std::size_t size) : file(bytes, size) {}
};

namespace {

constexpr const char* kFormats[] = {"openexr", "tiff"};

// The first line of what went wrong.
void tell(char* message, const std::string& text) {
    const std::string line = text.substr(0, text.find('\n'));
    std::snprintf(message, kModuleMessageBytes, "%s", line.empty() ? "unknown error" : line.c_str());
}

// Runs f(), which returns false when something went wrong and `message` says what.
template <class F>
bool guarded(char* message, const F& f) noexcept {
    try {
        return f();
    } catch (const std::bad_alloc&) {
        std::snprintf(message, kModuleMessageBytes, "not enough memory");
    } catch (const std::exception& e) {
        std::snprintf(message, kModuleMessageBytes, "%.200s", e.what());
    } catch (...) {
        std::snprintf(message, kModuleMessageBytes, "unknown error");
    }
    return false;
}

// Neither OpenImageIO nor OpenEXR (-1: no pool) shall start threads of its own, and nothing is printed.
void set_up() {
    static std::once_flag once;
    std::call_once(once, [] {
        OIIO::attribute("debug", 0);
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
        OIIO::attribute("try_all_readers", 0);
    });
}

ModuleSample sample_of(OIIO::TypeDesc type) {
    if (type == OIIO::TypeUInt8) return kModuleU8;
    if (type == OIIO::TypeUInt16) return kModuleU16;
    if (type == OIIO::TypeHalf) return kModuleHalf;
    if (type == OIIO::TypeFloat) return kModuleFloat;
    if (type == OIIO::TypeUInt32) return kModuleU32;
    return kModuleOther;
}

OIIO::TypeDesc type_of(ModuleSample sample) {
    switch (sample) {
        case kModuleU8:
            return OIIO::TypeUInt8;
        case kModuleU16:
            return OIIO::TypeUInt16;
        case kModuleHalf:
            return OIIO::TypeHalf;
        case kModuleFloat:
            return OIIO::TypeFloat;
        default:
            return OIIO::TypeUInt32;
    }
}

bool open_input(ModuleReader& reader, ModuleFormat format, ModulePicture& picture, char* message) {
    set_up();
    const char* name = kFormats[format];
    reader.input = OIIO::ImageInput::create(name);
    if (!reader.input || reader.input->format_name() != std::string(name)) {
        OIIO::geterror();
        tell(message, std::string("this OpenImageIO does not read ") + name);
        return false;
    }
    reader.input->threads(1);
    // Alpha as it is stored. The name is for messages only.
    OIIO::ImageSpec wishes, spec;
    wishes.attribute("oiio:UnassociatedAlpha", 1);
    const std::string file_name = std::string("picture.") + name;
    if (!reader.input->set_ioproxy(&reader.file) || !reader.input->open(file_name, spec, wishes)) {
        tell(message, reader.input->geterror());
        return false;
    }
    if (spec.deep || spec.depth > 1) {
        tell(message, "deep pictures and volumes are not read");
        return false;
    }
    picture = {spec.width, spec.height, spec.nchannels, spec.alpha_channel,
               spec.get_int_attribute("oiio:UnassociatedAlpha", 0)};
    return true;
}

ModuleReader* open(ModuleFormat format, const void* file, std::size_t size, ModulePicture* picture, char* message) {
    std::unique_ptr<ModuleReader> reader;
    const bool opened = guarded(message, [&] {
        reader = std::make_unique<ModuleReader>(file, size);
        return open_input(*reader, format, *picture, message);
    });
    return opened ? reader.release() : nullptr;
}

const char* channel_name(const ModuleReader* reader, std::int32_t channel) {
    const OIIO::ImageSpec& spec = reader->input->spec();
    return static_cast<std::size_t>(channel) < spec.channelnames.size()
               ? spec.channelnames[static_cast<std::size_t>(channel)].c_str()
               : "";
}

ModuleSample channel_sample(const ModuleReader* reader, std::int32_t channel) {
    return sample_of(reader->input->spec().channelformat(channel));
}

std::int32_t read(ModuleReader* reader, std::int32_t first, std::int32_t end, void* pixels, std::size_t size,
                  char* message) {
    return guarded(message, [&] {
        const OIIO::ImageSpec& spec = reader->input->spec();
        const std::size_t count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
        if (first < 0 || first >= end || end > spec.nchannels || spec.pixel_bytes(first, end, true) * count != size) {
            tell(message, "the picture has another shape than its header says");
            return false;
        }
        const bool fine = reader->input->read_image(0, 0, first, end, OIIO::TypeUnknown, pixels);
        if (!fine) tell(message, reader->input->geterror());
        return fine;
    });
}

void close(ModuleReader* reader) {
    char message[kModuleMessageBytes];
    guarded(message, [&] {
        delete reader;
        return true;
    });
}

// Nothing but what the pixels need: no date, no host, no program.
OIIO::ImageSpec spec_of(const ModuleOutput& output) {
    const auto channels = static_cast<std::size_t>(output.channels);
    OIIO::ImageSpec spec(output.width, output.height, output.channels, type_of(output.samples[0]));
    if (output.names != nullptr) {
        spec.channelnames.assign(output.names, output.names + channels);
        spec.alpha_channel = -1;
        for (std::size_t c = 0; c < channels; ++c) {
            spec.channelformats.push_back(type_of(output.samples[c]));
            if (spec.channelnames[c] == "A") spec.alpha_channel = static_cast<int>(c);
        }
    }
    spec.attribute("compression", "zip");
    // OpenImageIO writes the time of day unless there is one, and leaves out one that is no text.
    spec.attribute("DateTime", 0);
    const bool floating = output.samples[0] == kModuleFloat || output.samples[0] == kModuleHalf;
    if (output.format == kModuleTiff && !floating) spec.attribute("oiio:UnassociatedAlpha", 1);
    return spec;
}

std::int32_t write(const ModuleOutput* output, void (*sink)(void* context, const void* bytes, std::size_t size),
                   void* context, char* message) {
    return guarded(message, [&] {
        set_up();
        const char* name = kFormats[output->format];
        OIIO::Filesystem::IOVecOutput file;
        const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(name);
        if (!out || out->format_name() != std::string(name)) {
            OIIO::geterror();
            tell(message, std::string("this OpenImageIO does not write ") + name);
            return false;
        }
        out->threads(1);
        if (!out->set_ioproxy(&file) || !out->open(std::string("picture.") + name, spec_of(*output)) ||
            !out->write_image(OIIO::TypeUnknown, output->pixels) || !out->close()) {
            tell(message, out->geterror());
            return false;
        }
        sink(context, file.buffer().data(), file.buffer().size());
        return true;
    });
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const ImageModule tessera_image_module;
const ImageModule tessera_image_module{kImageModuleVersion, open, channel_name, channel_sample, read, close, write};

}  // namespace tessera
