// Conversions between Tessera's plain types and GLM's (float), for programs that use GLM. Optional:
// tessera.h does not include it, and the library's interface does not need GLM. Both store matrices by
// columns; quaternions are converted by component name, whatever GLM's storage order is.
#pragma once

#include <tessera/types.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace tessera {

inline glm::vec2 to_glm(Vec2 v) { return glm::vec2(v.x, v.y); }
inline glm::vec3 to_glm(Vec3 v) { return glm::vec3(v.x, v.y, v.z); }
inline glm::vec4 to_glm(Vec4 v) { return glm::vec4(v.x, v.y, v.z, v.w); }
inline glm::quat to_glm(Quat q) {
    glm::quat r;
    r.x = q.x, r.y = q.y, r.z = q.z, r.w = q.w;
    return r;
}
inline glm::mat4 to_glm(const Mat4& m) {
    glm::mat4 r(1.0f);
    for (int c = 0; c < 4; ++c)
        for (int row = 0; row < 4; ++row) r[c][row] = m(row, c);
    return r;
}

inline Vec2 from_glm(const glm::vec2& v) { return {v.x, v.y}; }
inline Vec3 from_glm(const glm::vec3& v) { return {v.x, v.y, v.z}; }
inline Vec4 from_glm(const glm::vec4& v) { return {v.x, v.y, v.z, v.w}; }
inline Quat from_glm(const glm::quat& q) { return {q.x, q.y, q.z, q.w}; }
inline Mat4 from_glm(const glm::mat4& m) {
    Mat4 r;
    for (int c = 0; c < 4; ++c)
        for (int row = 0; row < 4; ++row) r(row, c) = m[c][row];
    return r;
}

}  // namespace tessera
