#include "scene/vertex_normals.h"

#include "core/fp_environment.h"
#include "simd/math.h"

#include <array>
#include <cmath>

namespace tessera {
namespace {

using Vector = std::array<double, 3>;

Vector between(const Vec3& a, const Vec3& b) {
    return {static_cast<double>(b.x) - static_cast<double>(a.x), static_cast<double>(b.y) - static_cast<double>(a.y),
            static_cast<double>(b.z) - static_cast<double>(a.z)};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Unit normals of the triangles; zero without area.
std::vector<Vec3> face_normals(std::span<const Vec3> positions, std::span<const std::uint32_t> corners) {
    std::vector<Vec3> normals(corners.size() / 3, Vec3{0, 0, 0});
    for (std::size_t t = 0; t < normals.size(); ++t) {
        const Vec3 &a = positions[corners[3 * t]], &b = positions[corners[3 * t + 1]],
                   &c = positions[corners[3 * t + 2]];
        const Vector n = cross(between(a, b), between(a, c));
        const double length = std::sqrt(dot(n, n));
        if (length > 0)
            normals[t] = {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
                          static_cast<float>(n[2] / length)};
    }
    return normals;
}

// Whether two triangles shade as one surface. Those without area have no say and join everybody.
bool joins(const Vec3& a, const Vec3& b) {
    const float cosine = a.x * b.x + a.y * b.y + a.z * b.z;
    return cosine >= 0.5f || a == Vec3{0, 0, 0} || b == Vec3{0, 0, 0};
}

}  // namespace

std::vector<std::uint32_t> crease_groups(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                                         std::size_t& count) {
    const FpEnvironment exact;
    constexpr std::size_t kMost = 64;
    const std::vector<Vec3> normals = face_normals(positions, corners);
    // The corners at each position, one list after another.
    std::vector<std::uint32_t> first(positions.size() + 1, 0), at(corners.size());
    for (const std::uint32_t p : corners) ++first[p + 1];
    for (std::size_t p = 0; p < positions.size(); ++p) first[p + 1] += first[p];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t c = 0; c < corners.size(); ++c) at[next[corners[c]]++] = c;

    std::vector<std::uint32_t> groups(corners.size());
    count = 0;
    for (std::size_t p = 0; p < positions.size(); ++p) {
        const std::span<const std::uint32_t> here(at.data() + first[p], first[p + 1] - first[p]);
        if (here.empty()) continue;
        if (here.size() > kMost) {
            for (const std::uint32_t c : here) groups[c] = static_cast<std::uint32_t>(count);
            ++count;
            continue;
        }
        // Everything that hangs together gets one number, in the order of the first corners.
        std::array<std::uint8_t, kMost> pending;
        std::uint64_t done = 0;
        for (std::size_t i = 0; i < here.size(); ++i) {
            if (done >> i & 1) continue;
            std::size_t waiting = 0;
            pending[waiting++] = static_cast<std::uint8_t>(i);
            done |= std::uint64_t{1} << i;
            while (waiting > 0) {
                const std::size_t j = pending[--waiting];
                groups[here[j]] = static_cast<std::uint32_t>(count);
                for (std::size_t k = 0; k < here.size(); ++k) {
                    if (done >> k & 1 || !joins(normals[here[j] / 3], normals[here[k] / 3])) continue;
                    done |= std::uint64_t{1} << k;
                    pending[waiting++] = static_cast<std::uint8_t>(k);
                }
            }
            ++count;
        }
    }
    return groups;
}

std::vector<Vec3> angle_weighted_normals(std::span<const Vec3> positions, std::span<const std::uint32_t> corners,
                                         std::span<const std::uint32_t> groups, std::size_t count) {
    const FpEnvironment exact;
    std::vector<Vector> sums(count, Vector{});
    for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
        const Vec3* p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = &positions[corners[t + k]];
        const Vector normal = cross(between(*p[0], *p[1]), between(*p[0], *p[2]));
        const double length = std::sqrt(dot(normal, normal));
        if (!(length > 0)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vector next = between(*p[k], *p[(k + 1) % 3]), last = between(*p[k], *p[(k + 2) % 3]);
            const Vector sine = cross(next, last);
            const double angle = math::atan2(std::sqrt(dot(sine, sine)), dot(next, last));
            Vector& sum = sums[groups[t + k]];
            for (std::size_t i = 0; i < 3; ++i) sum[i] += normal[i] * (angle / length);
        }
    }
    std::vector<Vec3> normals(count, Vec3{0, 0, 1});
    for (std::size_t i = 0; i < count; ++i) {
        const double length = std::sqrt(dot(sums[i], sums[i]));
        // Opposite faces may leave nothing but rounding.
        if (!(length > 1e-9)) continue;
        normals[i] = {static_cast<float>(sums[i][0] / length), static_cast<float>(sums[i][1] / length),
                      static_cast<float>(sums[i][2] / length)};
    }
    return normals;
}

}  // namespace tessera
