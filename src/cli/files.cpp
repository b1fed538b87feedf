#include "cli/files.h"

#include <tessera/error.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace tessera::cli {
namespace {

[[noreturn]] void fail_output(const std::string& path, int error) {
    const std::string name = path == "-" ? "<stdout>" : path;
    throw Error(ErrorCode::kOutput, "cannot be written: " + std::string(std::strerror(error)), name);
}

// Returns 0 or the error number.
int write_all(int descriptor, std::span<const std::byte> data) {
    while (!data.empty()) {
        const ssize_t written = ::write(descriptor, data.data(), data.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        data = data.subspan(static_cast<std::size_t>(written));
    }
    return 0;
}

std::string folder_of(const std::string& path) {
    const auto slash = path.rfind('/');
    if (slash == std::string::npos) return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

bool is_special(const std::string& path) {
    struct stat info {};
    return ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode);
}

void write_directly(const std::string& path, int descriptor, std::span<const std::byte> data) {
    if (const int error = write_all(descriptor, data)) fail_output(path, error);
}

}  // namespace

std::vector<std::byte> read_stdin(std::uint64_t max_bytes) {
    constexpr std::size_t kChunk = std::size_t{1} << 20;
    std::vector<std::byte> data;
    for (;;) {
        const std::size_t used = data.size();
        data.resize(used + kChunk);
        const ssize_t got = ::read(STDIN_FILENO, data.data() + used, kChunk);
        data.resize(used + (got > 0 ? static_cast<std::size_t>(got) : 0));
        if (got == 0) return data;
        if (got < 0 && errno != EINTR)
            throw Error(ErrorCode::kInput, "cannot be read: " + std::string(std::strerror(errno)), "<stdin>");
        if (data.size() > max_bytes)
            throw Error(ErrorCode::kLimit, "more than " + std::to_string(max_bytes) + " bytes", "<stdin>");
    }
}

void check_writable(const std::string& path) {
    if (path == "-") return;
    struct stat info {};
    if (::stat(path.c_str(), &info) == 0) {
        if (S_ISDIR(info.st_mode)) fail_output(path, EISDIR);
        if (!S_ISREG(info.st_mode)) return;
    }
    if (::access(folder_of(path).c_str(), W_OK | X_OK) != 0) fail_output(path, errno);
}

void write_output(const std::string& path, std::span<const std::byte> data) {
    if (path == "-") return write_directly(path, STDOUT_FILENO, data);
    const bool special = is_special(path);
    std::string name = special ? path : path + ".XXXXXX";
    const int descriptor = special ? ::open(path.c_str(), O_WRONLY | O_CLOEXEC) : ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor < 0) fail_output(path, errno);
    int error = write_all(descriptor, data);
    if (!special) {
        // mkostemp makes files that only the owner may read; a picture gets the usual rights.
        const mode_t mask = ::umask(0);
        ::umask(mask);
        if (error == 0 && ::fchmod(descriptor, 0666 & ~mask) != 0) error = errno;
    }
    if (::close(descriptor) != 0 && error == 0) error = errno;
    if (!special && error == 0 && ::rename(name.c_str(), path.c_str()) != 0) error = errno;
    if (error != 0) {
        if (!special) ::unlink(name.c_str());
        fail_output(path, error);
    }
}

void write_output(const std::string& path, std::string_view text) {
    write_output(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace tessera::cli
