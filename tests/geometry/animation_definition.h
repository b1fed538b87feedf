// Animation samplers by their definition, in long double: what the tests compare with.
#pragma once

#include <tessera/scene.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tessera::test {

using Real = long double;

// Appendix C of the specification, word by word.
inline std::vector<Real> definition(const AnimationSampler& s, Real time, std::size_t n, bool rotation) {
    const std::size_t keys = s.times.size();
    const bool cubic = s.interpolation == Interpolation::kCubicSpline;
    const auto value = [&](std::size_t k, std::size_t part, std::size_t i) {
        return static_cast<Real>(s.values[(cubic ? 3 * k + part : k) * n + i]);
    };
    std::vector<Real> out(n);
    std::size_t k = 0;
    while (k + 1 < keys && static_cast<Real>(s.times[k + 1]) <= time) ++k;
    const bool holds = time < static_cast<Real>(s.times[0]) || k + 1 == keys || s.interpolation == Interpolation::kStep;
    if (holds) {
        for (std::size_t i = 0; i < n; ++i) out[i] = value(k, 1, i);
    } else {
        const Real td = static_cast<Real>(s.times[k + 1]) - static_cast<Real>(s.times[k]);
        const Real t = (time - static_cast<Real>(s.times[k])) / td;
        if (cubic) {
            for (std::size_t i = 0; i < n; ++i)
                out[i] = (2 * t * t * t - 3 * t * t + 1) * value(k, 1, i) +
                         td * (t * t * t - 2 * t * t + t) * value(k, 2, i) +
                         (-2 * t * t * t + 3 * t * t) * value(k + 1, 1, i) +
                         td * (t * t * t - t * t) * value(k + 1, 0, i);
        } else if (rotation) {
            Real a[4], b[4], la = 0, lb = 0, d = 0;
            for (std::size_t i = 0; i < 4; ++i)
                la += value(k, 1, i) * value(k, 1, i), lb += value(k + 1, 1, i) * value(k + 1, 1, i);
            for (std::size_t i = 0; i < 4; ++i) {
                a[i] = value(k, 1, i) / std::sqrt(la), b[i] = value(k + 1, 1, i) / std::sqrt(lb);
                d += a[i] * b[i];
            }
            const Real angle = std::acos(std::min<Real>(std::fabs(d), 1)), sign = d < 0 ? -1 : 1;
            for (std::size_t i = 0; i < 4; ++i)
                out[i] = angle < 1e-6L
                             ? (1 - t) * a[i] + t * sign * b[i]
                             : (std::sin(angle * (1 - t)) * a[i] + sign * std::sin(angle * t) * b[i]) / std::sin(angle);
        } else {
            for (std::size_t i = 0; i < n; ++i) out[i] = (1 - t) * value(k, 1, i) + t * value(k + 1, 1, i);
        }
    }
    if (rotation) {
        Real squared = 0;
        for (const Real x : out) squared += x * x;
        for (Real& x : out) x /= std::sqrt(squared);
    }
    return out;
}

}  // namespace tessera::test
