#include "cli/temporary_file.h"

#include <tessera/error.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace tessera::cli {
namespace {

constexpr std::string_view kMark = ".tessera-";
constexpr std::size_t kRandom = 6;

[[noreturn]] void fail(const std::string& target, int error) {
    throw Error(ErrorCode::kOutput, "cannot be written: " + std::string(std::strerror(error)), target);
}

// umask() can only be read by setting it, for all threads: so Linux is asked first, and that once.
mode_t usual_mask() {
    static const mode_t mask = [] {
        constexpr std::string_view kName = "Umask:";
        std::ifstream status("/proc/self/status");
        for (std::string line; std::getline(status, line);)
            if (line.starts_with(kName))
                return static_cast<mode_t>(std::strtoul(line.c_str() + kName.size(), nullptr, 8));
        const mode_t set = ::umask(0);
        ::umask(set);
        return set;
    }();
    return mask;
}

}  // namespace

void remember_umask() { usual_mask(); }

TemporaryFile::TemporaryFile(std::string target) : target_(std::move(target)) {
    // Another process may take a file that has no lock yet for a leftover; then the next name is tried.
    constexpr int kTries = 100;
    for (int i = 0; i < kTries; ++i) {
        name_ = target_;
        name_ += kMark;
        name_.append(kRandom, 'X');
        descriptor_ = ::mkostemp(name_.data(), O_CLOEXEC);
        if (descriptor_ < 0) fail(target_, errno);
        if (lock()) return;
        ::close(std::exchange(descriptor_, -1));
    }
    fail(target_, EBUSY);
}

// False when the file is, or is being, removed by another process.
bool TemporaryFile::lock() {
    int result = 0;
    while ((result = ::flock(descriptor_, LOCK_EX | LOCK_NB)) != 0 && errno == EINTR) {
    }
    if (result != 0 && errno == EWOULDBLOCK) return false;
    // A file system without locks loses only the cleaning. A name that is gone was taken before the lock.
    struct stat named {};
    return ::lstat(name_.c_str(), &named) == 0 || errno != ENOENT;
}

TemporaryFile::~TemporaryFile() {
    if (!name_.empty()) ::unlink(name_.c_str());
    if (descriptor_ >= 0) ::close(descriptor_);
}

void TemporaryFile::publish() {
    // mkostemp makes files that only the owner may read; a picture gets the usual rights.
    if (::fchmod(descriptor_, 0666 & ~usual_mask()) != 0) fail(target_, errno);
    // Some file systems say only at a close that there was no room. The lock stays with the other descriptor until the
    // file has its name.
    const int copy = ::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0);
    if (copy < 0 || ::close(copy) != 0) fail(target_, errno);
    if (::rename(name_.c_str(), target_.c_str()) != 0) fail(target_, errno);
    name_.clear();
    ::close(std::exchange(descriptor_, -1));
}

std::string folder_of(const std::string& path) {
    const auto slash = path.rfind('/');
    if (slash == std::string::npos) return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

void StaleFiles::remove(const std::string& target) {
    const std::lock_guard lock(mutex_);
    const std::string folder = folder_of(target);
    const auto [known, is_new] = folders_.try_emplace(folder);
    if (is_new) {
        std::error_code ignored;
        for (std::filesystem::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
             entry.increment(ignored)) {
            const std::string name = entry->path().filename().string();
            if (name.size() <= kMark.size() + kRandom) continue;
            const std::size_t mark = name.size() - kMark.size() - kRandom;
            if (name.compare(mark, kMark.size(), kMark) == 0)
                known->second.emplace(name.substr(0, mark), entry->path().string());
        }
    }
    const auto [first, last] = known->second.equal_range(target.substr(target.rfind('/') + 1));
    for (auto leftover = first; leftover != last; ++leftover) {
        const int descriptor = ::open(leftover->second.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (descriptor < 0) continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(leftover->second.c_str());
        ::close(descriptor);
    }
    known->second.erase(first, last);
}

}  // namespace tessera::cli
