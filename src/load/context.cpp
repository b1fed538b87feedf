#include "load/context.h"

namespace tessera {

void LoadContext::charge(std::uint64_t bytes, const std::string& place) {
    if (bytes > options_.max_bytes - charged_)  // never wraps: charged_ <= max_bytes
        throw Error(ErrorCode::kLimit,
                    "needs " + std::to_string(bytes) + " bytes more, beyond the limit of " +
                        std::to_string(options_.max_bytes) + " bytes",
                    file_, place);
    charged_ += bytes;
}

void LoadContext::warn(std::string_view text) {
    constexpr std::size_t kMost = 64, kLongest = 400;
    if (warnings_.size() > kMost) return;
    if (warnings_.size() == kMost) {
        warnings_.emplace_back("further warnings are left out");
        return;
    }
    std::string line(text.substr(0, kLongest));
    for (char& c : line)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    warnings_.push_back(std::move(line));
}

}  // namespace tessera
