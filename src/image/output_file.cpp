// Writing a file whole or not at all: a temporary file beside the target, renamed at the end.
#include "image/codecs.h"

#include <tessera/error.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace tessera {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, int error, const std::string& path) {
    throw Error(ErrorCode::kOutput, std::string(what) + ": " + std::strerror(error), path);
}

// An open file descriptor and, while `temporary` is set, a name to remove when things go wrong.
struct Output {
    int descriptor = -1;
    std::string temporary;

    Output() = default;
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;
    ~Output() {
        if (descriptor >= 0) ::close(descriptor);
        if (!temporary.empty()) ::unlink(temporary.c_str());
    }
};

// Creates a file beside `target` under a name that no other process or thread uses.
void open_temporary(Output& output, const fs::path& target, const std::string& path) {
    for (unsigned attempt = 0; attempt < 10000; ++attempt) {
        const fs::path name =
            target.parent_path() / (".tessera-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".tmp");
        output.descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (output.descriptor >= 0) {
            output.temporary = name.string();
            return;
        }
        if (errno != EEXIST) fail("cannot write", errno, path);
    }
    fail("cannot write", EEXIST, path);
}

void write_all(int descriptor, std::span<const std::byte> bytes, const std::string& path) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail("cannot write", errno, path);
        bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
}

void close_checked(Output& output, const std::string& path) {
    const int descriptor = output.descriptor;
    output.descriptor = -1;
    if (::close(descriptor) != 0 && errno != EINTR) fail("cannot write", errno, path);
}

}  // namespace

void write_file(const std::string& path, std::span<const std::byte> bytes) {
    Output output;
    std::error_code ignored;
    fs::path target = path;
    // Through a symbolic link, so that the link stays one.
    if (fs::is_symlink(target, ignored))
        if (const fs::path real = fs::weakly_canonical(target, ignored); !ignored) target = real;

    const fs::file_status status = fs::status(target, ignored);
    if (fs::is_directory(status)) fail("cannot write", EISDIR, path);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        output.descriptor = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
        if (output.descriptor < 0) fail("cannot write", errno, path);
        write_all(output.descriptor, bytes, path);
        close_checked(output, path);
        return;
    }
    open_temporary(output, target, path);
    write_all(output.descriptor, bytes, path);
    close_checked(output, path);
    if (std::rename(output.temporary.c_str(), target.c_str()) != 0) fail("cannot write", errno, path);
    output.temporary.clear();
}

}  // namespace tessera
