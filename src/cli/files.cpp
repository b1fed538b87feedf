#include "cli/files.h"

#include "cli/temporary_file.h"

#include <tessera/error.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

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

std::vector<std::byte> read_file(const std::string& path) {
    const auto fail = [&](int error) {
        throw Error(ErrorCode::kInput, std::string("cannot be read: ") + std::strerror(error), path);
    };
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) fail(errno);
    struct stat info {};
    std::vector<std::byte> data;
    if (::fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode)) data.resize(static_cast<std::size_t>(info.st_size));
    std::size_t used = 0;
    int error = S_ISREG(info.st_mode) ? 0 : EINVAL;
    while (error == 0 && used < data.size()) {
        const ssize_t got = ::read(descriptor, data.data() + used, data.size() - used);
        if (got == 0) break;
        if (got > 0)
            used += static_cast<std::size_t>(got);
        else if (errno != EINTR)
            error = errno;
    }
    ::close(descriptor);
    if (error != 0) fail(error);
    data.resize(used);
    return data;
}

bool is_folder(const std::string& path) {
    std::error_code unknown;
    return std::filesystem::is_directory(path, unknown);
}

void make_folders_of(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(folder_of(path), error);
    if (error) fail_output(path, error.value());
}

void check_folder_writable(const std::string& folder) {
    const std::string path = folder.empty() ? "." : folder;
    if (!is_folder(path)) fail_output(path, ENOTDIR);
    if (::access(path.c_str(), W_OK | X_OK) != 0) fail_output(path, errno);
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
    if (is_special(path)) {
        const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor < 0) fail_output(path, errno);
        const int error = write_all(descriptor, data);
        if (::close(descriptor) != 0 || error != 0) fail_output(path, error != 0 ? error : errno);
        return;
    }
    TemporaryFile file(path);
    write_directly(path, file.descriptor(), data);
    file.publish();
}

void write_output(const std::string& path, std::string_view text) {
    write_output(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace tessera::cli
