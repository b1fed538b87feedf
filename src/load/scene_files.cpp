#include "load/scene_files.h"

#include "load/uri.h"

namespace tessera {

Bytes FolderFiles::read(LoadContext& context, const std::string& path, std::uint64_t most,
                        const std::string& place) const {
    const FileHandle file = open_path_below(context, folder_, path, place);
    return read_open_file(context, file, most, place);
}

}  // namespace tessera
