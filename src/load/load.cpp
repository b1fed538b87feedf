// The entry points: which format is it, and whose reader is called.
#include <tessera/load.h>

#include "load/context.h"
#include "load/file.h"
#include "load/glb.h"
#include "load/gltf.h"
#include "load/obj.h"
#include "load/obj_text.h"
#include "load/ply.h"
#include "load/stl.h"
#include "load/zip.h"

#include <new>
#include <stdexcept>

namespace tessera {
namespace {

// glTF's JSON text begins with "{" after a byte order mark and white space.
bool looks_like_json(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && text[first] == '{';
}

bool has_extension(std::string_view name, std::string_view extension) {
    if (name.size() < extension.size()) return false;
    name.remove_prefix(name.size() - extension.size());
    for (std::size_t i = 0; i < extension.size(); ++i) {
        const char c = name[i] >= 'A' && name[i] <= 'Z' ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
        if (c != extension[i]) return false;
    }
    return true;
}

// By content first; OBJ and ASCII STL have no mark of their own, so there the extension comes first.
Scene read_plain(LoadContext& context, std::span<const std::byte> file, const SceneFiles& files) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (is_glb(file)) {
        const GlbChunks chunks = split_glb(context, file);
        return read_gltf(context, chunks.json, chunks.binary, files);
    }
    if (is_ply(file)) return read_ply(context, file, files);
    if (has_extension(context.file(), ".obj")) return read_obj(context, text, files);
    if (file.empty()) context.fail("the file is empty");
    if (has_extension(context.file(), ".stl") || is_binary_stl(file)) return read_stl(context, file);
    if (looks_like_json(text)) return read_gltf(context, text, std::nullopt, files);
    if (has_extension(context.file(), ".gltf")) context.fail("not a glTF file: it does not begin with \"{\"");
    if (has_extension(context.file(), ".glb")) context.fail("not a GLB file: it does not begin with \"glTF\"");
    if (has_extension(context.file(), ".ply")) context.fail("not a PLY file: it does not begin with \"ply\"");
    if (is_ascii_stl(file)) return read_stl(context, file);
    if (looks_like_obj(text)) return read_obj(context, text, files);
    context.fail("not a scene format that Tessera reads (glTF 2.0: .gltf, .glb; .obj; .ply; .stl; .zip of one)");
}

// An archive is read as the scene in it.
Scene read_any(LoadContext& context, std::span<const std::byte> file, const std::string& folder) {
    if (!is_zip(file)) return read_plain(context, file, FolderFiles(folder));
    const ZipFiles archive(context, file);
    const Bytes scene = archive.read_scene(context);
    context.enter(archive.scene());
    return read_plain(context, scene.span(), archive);
}

// Memory that runs out below the configured limit is a limit too.
template <class F>
Scene guarded(const std::string& name, F&& load) {
    try {
        return load();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::kLimit, "out of memory", name);
    } catch (const std::length_error&) {
        throw Error(ErrorCode::kLimit, "out of memory", name);
    }
}

std::string folder_of(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    if (slash == std::string::npos) return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

}  // namespace

Scene load_scene(const std::string& path, const LoadOptions& options) {
    return guarded(path, [&] {
        LoadContext context(path, options);
        const Bytes file = read_whole_file(context, path);
        return read_any(context, file.span(), folder_of(path));
    });
}

Scene load_scene_from_memory(std::span<const std::byte> file, const std::string& base_folder,
                             const LoadOptions& options, const std::string& name) {
    return guarded(name, [&] {
        LoadContext context(name, options);
        return read_any(context, file, base_folder);
    });
}

}  // namespace tessera
