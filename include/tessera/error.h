// The one exception type of the library. Loading and argument checks throw it; rendering throws it
// only for its limits (memory, pixels, cancelled). The library never prints, exits or aborts.
// what() is one line: "file: location: message", with the parts that are known.
#pragma once

#include <tessera/export.h>

#include <stdexcept>
#include <string>

namespace tessera {

enum class ErrorCode {
    kInternal,   // a fault of Tessera itself
    kUsage,      // an argument or option that makes no sense
    kInput,      // a file that cannot be read or is not valid
    kOutput,     // a file that cannot be written
    kLimit,      // a configured limit or the memory was exceeded
    kCancelled,  // the caller's cancel callback said stop
};

class TESSERA_API Error : public std::runtime_error {
  public:
    // `file` is a path or "" when none is known; `location` is a place inside it, such as a JSON
    // path ("/accessors/3/count") or a byte offset, or "".
    Error(ErrorCode code, const std::string& message, const std::string& file = {}, const std::string& location = {});
    Error(const Error&) = default;
    Error& operator=(const Error&) = default;
    ~Error() override;

    ErrorCode code() const noexcept { return code_; }
    const std::string& message() const noexcept { return message_; }
    const std::string& file() const noexcept { return file_; }
    const std::string& location() const noexcept { return location_; }

  private:
    ErrorCode code_;
    std::string message_, file_, location_;
};

}  // namespace tessera
