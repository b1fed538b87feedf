#include "scene/check.h"

#include <tessera/error.h>

#include "scene/numbers.h"

namespace tessera {

std::string Place::text() const {
    std::string result = parent ? parent->text() : std::string();
    if (!result.empty()) result += '/';
    result += name;
    if (index != kNoIndex) result += '/' + std::to_string(index);
    return result;
}

void Place::fail(const std::string& message) const { throw Error(ErrorCode::kUsage, message, "", text()); }

void Place::reference(int value, std::size_t size, std::string_view name_of_it) const {
    if (value == kNone || (value >= 0 && static_cast<std::size_t>(value) < size)) return;
    child(name_of_it)
        .fail("there is no number " + std::to_string(value) + " (the scene has " + std::to_string(size) + ")");
}

void Place::finite(const float* values, std::size_t count) const {
    const std::span<const float> all(values, count);
    if (all_finite(all)) return;
    fail("number " + std::to_string(first_not_finite(all)) + " is not finite");
}

void validate(const Scene& scene) {
    check_hierarchy(scene);
    check_appearance(scene);
    check_meshes(scene, true);
    check_animations(scene, true);
}

}  // namespace tessera
