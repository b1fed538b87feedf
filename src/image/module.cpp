#include "image/module.h"

#include "core/fp_environment.h"

#include <tessera/error.h>
#include <tessera/image_files.h>

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

namespace tessera {
namespace {

namespace fs = std::filesystem;

struct Outcome {
    const ImageModule* module = nullptr;
    std::string reason = "it was not found";
};

// The folder of the shared object or executable that this function is part of; "" when unknown.
fs::path own_folder() {
    std::error_code error;
    Dl_info info{};
    if (::dladdr(reinterpret_cast<const void*>(&find_image_module), &info) != 0 && info.dli_fname != nullptr &&
        std::string(info.dli_fname).find('/') != std::string::npos) {
        const fs::path object = fs::canonical(info.dli_fname, error);
        if (!error) return object.parent_path();
    }
    const fs::path executable = fs::read_symlink("/proc/self/exe", error);
    return error ? fs::path() : executable.parent_path();
}

std::vector<fs::path> candidates() {
    if (const char* named = ::secure_getenv("TESSERA_OIIO_MODULE")) return {fs::path(named)};
    const fs::path folder = own_folder();
    if (folder.empty()) return {};
    // The last one is for a command that the library is linked into: from bin to the library folder.
    return {folder / kImageModuleFile, folder / "tessera" / kImageModuleFile,
            folder / TESSERA_FROM_BIN_TO_LIBRARIES / "tessera" / kImageModuleFile};
}

Outcome open_module() {
    // Libraries that were built for fast arithmetic change the rounding of the thread that loads them.
    const FpEnvironment environment;
    Outcome outcome;
    for (const fs::path& path : candidates()) {
        std::error_code error;
        // An empty or plain name would make dlopen search elsewhere.
        if (!path.is_absolute() || !fs::is_regular_file(path, error)) continue;
        void* object = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (object == nullptr) {
            const char* reason = ::dlerror();
            outcome.reason = reason != nullptr ? reason : path.string() + " cannot be opened";
            continue;
        }
        const auto* module = static_cast<const ImageModule*>(::dlsym(object, kImageModuleSymbol));
        if (module != nullptr && module->version == kImageModuleVersion) return {module, {}};
        outcome.reason = path.string() + " is not of this version of Tessera";
        ::dlclose(object);
    }
    return outcome;
}

const Outcome& outcome() {
    static const Outcome once = open_module();
    return once;
}

}  // namespace

const ImageModule* find_image_module() noexcept {
    try {
        return outcome().module;
    } catch (...) {
        return nullptr;  // no memory for a path
    }
}

const ImageModule& require_image_module(const std::string& what, bool writing) {
    const Outcome& found = outcome();
    if (found.module != nullptr) return *found.module;
    throw Error(writing ? ErrorCode::kOutput : ErrorCode::kInput,
                what + " needs the OpenImageIO module " + kImageModuleFile + " (" + found.reason +
                    "): build Tessera with libopenimageio-dev installed, or name the module in TESSERA_OIIO_MODULE");
}

bool has_image_module() { return find_image_module() != nullptr; }

}  // namespace tessera
