#include "load/zip.h"

#include "load/text.h"
#include "load/uri.h"

#include <minizip/unzip.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <tuple>
#include <utility>

namespace tessera {
namespace {

constexpr std::uint64_t kMostEntries = 65536;
// Scenes in an archive, as they are looked for.
constexpr std::string_view kSceneExtensions[] = {".gltf", ".glb", ".obj", ".ply", ".stl"};

bool is_scene(std::string_view name) {
    std::string lower(name.substr(name.size() < 5 ? 0 : name.size() - 5));
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return std::any_of(std::begin(kSceneExtensions), std::end(kSceneExtensions),
                       [&](std::string_view extension) { return lower.ends_with(extension); });
}

// As other names say it: with forward slashes, without "." and empty parts. Folders have none.
std::string entry_name(std::string_view text) {
    std::string name(text), normal;
    std::replace(name.begin(), name.end(), '\\', '/');
    if (name.ends_with('/')) return {};
    for (std::size_t at = 0; at < name.size();) {
        const std::size_t end = std::min(name.find('/', at), name.size());
        const std::string part = name.substr(at, end - at);
        if (!part.empty() && part != ".") normal.append(normal.empty() ? "" : "/").append(part);
        at = end + 1;
    }
    return normal;
}

// APPNOTE.TXT of PKWARE, 4.4.5.
std::string packing_name(unsigned long method) {
    switch (method) {
        case 9:
            return "Deflate64";
        case 12:
            return "bzip2";
        case 14:
            return "LZMA";
        case 93:
            return "Zstandard";
        case 95:
            return "XZ";
        default:
            return "method " + std::to_string(method);
    }
}

// What other systems put beside the files.
bool is_hidden(std::string_view name) {
    return name.starts_with("__MACOSX/") || name.find("/.") != name.npos || name.starts_with('.');
}

// A file in memory for minizip: one reader at a time.
struct MemoryFile {
    std::span<const std::byte> bytes;
    std::uint64_t at = 0;
};

MemoryFile& file_of(void* stream) { return *static_cast<MemoryFile*>(stream); }
void* open_memory(void* opaque, const void*, int) { return opaque; }
uLong read_memory(void*, void* stream, void* to, uLong size) {
    MemoryFile& file = file_of(stream);
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(size, file.bytes.size() - file.at));
    std::memcpy(to, file.bytes.data() + file.at, count);
    file.at += count;
    return static_cast<uLong>(count);
}
uLong write_memory(void*, void*, const void*, uLong) { return 0; }
ZPOS64_T tell_memory(void*, void* stream) { return file_of(stream).at; }
long seek_memory(void*, void* stream, ZPOS64_T offset, int origin) {
    MemoryFile& file = file_of(stream);
    const std::uint64_t base = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                               : origin == ZLIB_FILEFUNC_SEEK_CUR ? file.at
                                                                  : file.bytes.size();
    if (offset > file.bytes.size() - base) return -1;
    file.at = base + offset;
    return 0;
}
int close_memory(void*, void*) { return 0; }
int error_memory(void*, void*) { return 0; }

}  // namespace

struct ZipFiles::Archive {
    MemoryFile file;
    unzFile zip = nullptr;
    std::map<std::string, unz64_file_pos> places;  // of the files, by name

    ~Archive() {
        if (zip) unzClose(zip);
    }
};

bool is_zip(std::span<const std::byte> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    return text.starts_with("PK\x03\x04") || text.starts_with("PK\x05\x06");
}

ZipFiles::ZipFiles(LoadContext& context, std::span<const std::byte> file) : archive_(std::make_unique<Archive>()) {
    archive_->file.bytes = file;
    zlib_filefunc64_def functions{&open_memory, &read_memory,  &write_memory, &tell_memory,
                                  &seek_memory, &close_memory, &error_memory, &archive_->file};
    archive_->zip = unzOpen2_64("", &functions);
    if (!archive_->zip) context.fail("no ZIP archive that can be read");
    unz_global_info64 info{};
    unzGetGlobalInfo64(archive_->zip, &info);
    if (info.number_entry > kMostEntries)
        context.fail(std::to_string(info.number_entry) + " files in the archive, at most 65536 are read");
    find_scene(context);
    if (scene_.empty()) context.fail("the archive holds no scene (.gltf, .glb, .obj, .ply, .stl)");
    const std::size_t slash = scene_.rfind('/');
    if (slash != std::string::npos) folder_ = scene_.substr(0, slash + 1);
}

ZipFiles::~ZipFiles() = default;

void ZipFiles::find_scene(LoadContext& context) {
    std::tuple<std::ptrdiff_t, std::string> best;
    for (int more = unzGoToFirstFile(archive_->zip); more == UNZ_OK; more = unzGoToNextFile(archive_->zip)) {
        char text[4096] = {};
        unz_file_info64 info{};
        if (unzGetCurrentFileInfo64(archive_->zip, &info, text, sizeof text - 1, nullptr, 0, nullptr, 0) != UNZ_OK)
            return;
        const std::string name = entry_name(text);
        if (name.empty()) continue;
        unz64_file_pos place{};
        unzGetFilePos64(archive_->zip, &place);
        context.charge(sizeof place + name.size() + 64);
        archive_->places.emplace(name, place);
        if (!is_scene(name) || is_hidden(name)) continue;
        std::tuple<std::ptrdiff_t, std::string> found{std::count(name.begin(), name.end(), '/'), name};
        if (scene_.empty() || found < best) best = std::move(found), scene_ = std::get<1>(best);
    }
}

Bytes ZipFiles::read_entry(LoadContext& context, const std::string& name, std::uint64_t most,
                           const std::string& place) const {
    const auto fail = [&](const std::string& reason) {
        context.fail(quoted(name) + " of the archive " + reason, place);
    };
    unz_file_info64 info{};
    const auto found = archive_->places.find(name);
    if (found == archive_->places.end()) fail("is not there");
    unz64_file_pos place_in_archive = found->second;
    if (unzGoToFilePos64(archive_->zip, &place_in_archive) != UNZ_OK ||
        unzGetCurrentFileInfo64(archive_->zip, &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK)
        fail("is damaged");
    if (info.flag & 1) fail("is encrypted");
    // minizip opens bzip2 too, and then reads nothing.
    if (info.compression_method != 0 && info.compression_method != Z_DEFLATED)
        fail("is packed with " + packing_name(info.compression_method) + "; only stored and deflated files are read");
    const std::uint64_t size = std::min<std::uint64_t>(info.uncompressed_size, most);
    context.charge(size, place);
    if (unzOpenCurrentFile(archive_->zip) != UNZ_OK) fail("is damaged");
    const auto close = [&] { return unzCloseCurrentFile(archive_->zip); };
    Bytes bytes(static_cast<std::size_t>(size));
    std::size_t done = 0;
    while (done < bytes.size()) {
        constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;
        const auto wanted = static_cast<unsigned>(std::min(bytes.size() - done, kMostAtOnce));
        const int got = unzReadCurrentFile(archive_->zip, bytes.data() + done, wanted);
        if (got <= 0) {
            close();
            fail(got < 0 ? "is damaged" : "is shorter than the archive says");
        }
        done += static_cast<std::size_t>(got);
    }
    // The checksum is compared when all was read.
    if (close() != UNZ_OK) fail("is damaged");
    return bytes;
}

Bytes ZipFiles::read_scene(LoadContext& context) const { return read_entry(context, scene_, UINT64_MAX, ""); }

Bytes ZipFiles::read(LoadContext& context, const std::string& path, std::uint64_t most,
                     const std::string& place) const {
    return read_entry(context, path_from(context, folder_, path, place), most, place);
}

}  // namespace tessera
