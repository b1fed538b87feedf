#include "load/pictures.h"

#include "core/parallel.h"
#include "image/codecs.h"
#include "image/foreign_formats.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

namespace tessera {
namespace {

bool begins_with(std::span<const std::byte> bytes, std::string_view magic) {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), reinterpret_cast<const char*>(bytes.data()));
}

// Formats that are known but not read; scenes that use them are drawn without these pictures.
std::string_view foreign_format(std::span<const std::byte> bytes) {
    if (begins_with(bytes, "\xabKTX 20\xbb")) return "KTX2";
    if (begins_with(bytes, "DDS ")) return "DDS";
    if (bytes.size() >= 12 && begins_with(bytes.subspan(4), "ftypavif")) return "AVIF";
    return {};
}

// What goes wrong with a picture, with its place.
[[noreturn]] void fail(const LoadContext& context, const PictureFile& file, const Error& error) {
    const std::string name = file.name.empty() ? std::string() : file.name + ": ";
    throw Error(error.code(), name + error.message(), context.file(), file.place);
}

// Of the formats that are read, those of floating-point values are no textures.
void check_format(const PictureFile& file) {
    for (const auto is : {is_png, is_jpeg, is_webp, is_tiff, is_hdr, is_exr})
        if (is(file.bytes)) return;
    const std::string_view format = foreign_picture_format(file.bytes);
    throw Error(ErrorCode::kInput, format.empty() ? "not a picture that can be a texture (PNG, JPEG, WebP or TIFF)"
                                                  : "pictures in " + std::string(format) +
                                                        " are not read; textures are PNG, JPEG, WebP or TIFF");
}

void charge_pixels(LoadContext& context, const PictureFile& file) {
    check_format(file);
    const ImageInfo info = read_image_info(file.bytes);
    const std::uint64_t pixels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
    if (pixels > context.options().max_pixels)
        throw Error(ErrorCode::kLimit, "a picture of " + std::to_string(info.width) + " x " +
                                           std::to_string(info.height) + " pixels, the limit is " +
                                           std::to_string(context.options().max_pixels) + " pixels");
    context.charge(pixels * (info.bits > 8 ? 8 : 4), file.place);
}

}  // namespace

void decode_pictures(LoadContext& context, std::vector<PictureFile>&& files, Scene& scene, PictureFaults faults) {
    // Runs f, and says whether it went well: damaged files may be no more than a warning, limits are errors.
    const auto attempt = [&](const PictureFile& file, auto&& f) {
        try {
            f();
            return true;
        } catch (const Error& error) {
            if (!error.file().empty()) throw;
            if (faults == PictureFaults::kFail || error.code() != ErrorCode::kInput) fail(context, file, error);
            context.warn(file.place + ": " + (file.name.empty() ? "" : file.name + ": ") + error.message());
            return false;
        }
    };
    std::vector<const PictureFile*> jobs;
    for (const PictureFile& file : files) {
        if (const std::string_view format = foreign_format(file.bytes); !format.empty()) {
            context.warn(file.place + ": pictures in " + std::string(format) + " are not read");
            continue;
        }
        if (attempt(file, [&] { charge_pixels(context, file); })) jobs.push_back(&file);
    }
    if (jobs.empty()) return;
    std::vector<std::shared_ptr<Image>> pixels(jobs.size());
    std::vector<std::exception_ptr> failures(jobs.size());
    Arena arena(context.options().threads);
    arena.for_each(jobs.size(), [&](std::size_t i) {
        try {
            pixels[i] = std::make_shared<Image>(decode_image(jobs[i]->bytes, context.options().max_pixels, true));
        } catch (...) {
            failures[i] = std::current_exception();
        }
    });
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        const bool fine = attempt(*jobs[i], [&] {
            if (failures[i]) std::rethrow_exception(failures[i]);
        });
        if (fine) scene.pictures[jobs[i]->picture].pixels = std::move(pixels[i]);
    }
}

}  // namespace tessera
