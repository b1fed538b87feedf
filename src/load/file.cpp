#include "load/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace tessera {

FileHandle::~FileHandle() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Bytes read_open_file(LoadContext& context, const FileHandle& file, std::uint64_t most, const std::string& place) {
    struct stat status {};
    if (::fstat(file.get(), &status) != 0)
        context.fail("cannot be read: " + std::generic_category().message(errno), place);
    if (!S_ISREG(status.st_mode)) context.fail("is not a regular file", place);
    const std::uint64_t size = std::min(static_cast<std::uint64_t>(status.st_size), most);
    context.charge(size, place);
    Bytes bytes(static_cast<std::size_t>(size));
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got = ::read(file.get(), bytes.data() + done, bytes.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) context.fail("cannot be read: " + std::generic_category().message(errno), place);
        if (got == 0) context.fail("became shorter while it was read", place);
        done += static_cast<std::size_t>(got);
    }
    return bytes;
}

Bytes read_whole_file(LoadContext& context, const std::string& path) {
    const std::string terminated(path.c_str());
    struct stat status {};
    if (terminated.size() != path.size()) context.fail("the path holds a zero character");
    if (::stat(path.c_str(), &status) != 0) context.fail(std::generic_category().message(errno));
    // Asked before opening: opening a device can have effects of its own.
    if (!S_ISREG(status.st_mode)) context.fail("is not a regular file");
    const FileHandle file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
    if (file.get() < 0) context.fail(std::generic_category().message(errno));
    return read_open_file(context, file, UINT64_MAX, "");
}

}  // namespace tessera
