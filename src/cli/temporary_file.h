// Files that are being written: under a name of their own beside their target, "a.png.tessera-k3Jx9Q", until they are
// complete. Each is locked (flock) by its writer, so that what a killed process left can be told from what another one
// is writing. Throws tessera::Error (kOutput) that names the target.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace tessera::cli {

class TemporaryFile {
  public:
    explicit TemporaryFile(std::string target);
    // Removes it, unless it was published.
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::string& target() const { return target_; }
    const std::string& name() const { return name_; }
    int descriptor() const { return descriptor_; }
    // Gives it the usual rights and its target's name.
    void publish();

  private:
    bool lock();

    std::string target_, name_;
    int descriptor_ = -1;
};

// Removes what killed processes left of targets. A folder is read once. Any thread may call.
class StaleFiles {
  public:
    void remove(const std::string& target);

  private:
    using Leftovers = std::multimap<std::string, std::string>;  // by target

    std::mutex mutex_;
    std::map<std::string, Leftovers> folders_;
};

// Reads the process' umask for all files to come. For main(), before there are other threads.
void remember_umask();

// "." for a bare name.
std::string folder_of(const std::string& path);

}  // namespace tessera::cli
