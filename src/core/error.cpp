#include <tessera/error.h>

namespace tessera {
namespace {

std::string one_line(const std::string& message, const std::string& file, const std::string& location) {
    std::string text;
    if (!file.empty()) text += file + ": ";
    if (!location.empty()) text += location + ": ";
    text += message;
    // Names inside files are hostile too: nothing may break the line or steer a terminal.
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

}  // namespace

Error::Error(ErrorCode code, const std::string& message, const std::string& file, const std::string& location)
    : std::runtime_error(one_line(message, file, location)),
      code_(code),
      message_(message),
      file_(file),
      location_(location) {}

Error::~Error() = default;

}  // namespace tessera
