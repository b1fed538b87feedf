// What one load carries along: the name for errors, the options, the memory taken so far and the
// warnings. One thread at a time.
#pragma once

#include <tessera/error.h>
#include <tessera/load.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

class LoadContext {
  public:
    LoadContext(std::string file, const LoadOptions& options) : file_(std::move(file)), options_(options) {}

    const std::string& file() const { return file_; }
    // From here on the file is one inside the one before.
    void enter(const std::string& name) { file_ += "/" + name; }
    const LoadOptions& options() const { return options_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

    // Called before memory is taken, with the size that a file asks for. Throws kLimit when the sum
    // of all calls exceeds LoadOptions::max_bytes.
    void charge(std::uint64_t bytes, const std::string& place = {});
    // Hostile files could fill the memory with warnings: the first 64 are kept, then one says so.
    // The text is cut to one line of printable characters.
    void warn(std::string_view text);

    [[noreturn]] void fail(const std::string& message, const std::string& place = {}) const {
        throw Error(ErrorCode::kInput, message, file_, place);
    }

  private:
    std::string file_;
    LoadOptions options_;
    std::uint64_t charged_ = 0;
    std::vector<std::string> warnings_;
};

}  // namespace tessera
