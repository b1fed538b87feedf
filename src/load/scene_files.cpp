#include "load/scene_files.h"

#include "load/uri.h"

namespace tessera {

Bytes FolderFiles::read(LoadContext& context, const std::string& path, std::uint64_t most,
                        const std::string& place) const {
    const FileHandle file = open_path_below(context, folder_, path, place);
    return read_open_file(context, file, most, place);
}

Bytes read_beside(LoadContext& context, const SceneFiles& files, const std::string& name, const std::string& place) {
    try {
        return files.read(context, name, UINT64_MAX, place);
    } catch (const Error& error) {
        const std::size_t slash = name.rfind('/');
        if (error.code() != ErrorCode::kInput || slash == std::string::npos || slash + 1 == name.size()) throw;
        return files.read(context, name.substr(slash + 1), UINT64_MAX, place);
    }
}

}  // namespace tessera
