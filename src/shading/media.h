// The media that a ray is in. Of those that overlap the one of the highest priority fills the space, of equals the one
// that was entered last (Schmidt and Budge 2002, "Simple nested dielectrics in ray traced images").
#pragma once

#include "shading/traced_shade.h"
#include "shading/vectors.h"
#include "simd/math.h"

#include <cstdint>

namespace tessera {

inline constexpr std::uint32_t kNoMedium = 0xffffffffu;

// By the materials of their surfaces, in the order in which they were entered.
struct Media {
    static constexpr int kMost = 6;  // more are not kept
    std::uint32_t material[kMost];
    int count = 0;

    bool has(std::uint32_t m) const {
        for (int i = 0; i < count; ++i)
            if (material[i] == m) return true;
        return false;
    }
    // What is beyond a surface of material m.
    Media beyond(std::uint32_t m, bool entering) const {
        Media other = *this;
        if (entering) {
            if (count < kMost) other.material[other.count++] = m;
            return other;
        }
        for (int i = count - 1; i >= 0; --i) {
            if (material[i] != m) continue;
            for (int k = i + 1; k < count; ++k) other.material[k - 1] = material[k];
            --other.count;
            break;
        }
        return other;
    }
    // The one that fills the space.
    std::uint32_t current(const MaterialView* materials) const {
        std::uint32_t found = kNoMedium;
        for (int i = 0; i < count; ++i)
            if (found == kNoMedium || materials[material[i]].priority >= materials[found].priority) found = material[i];
        return found;
    }
};

// A surface of material m between its two media.
struct Boundary {
    bool clear = false;  // the same medium on both sides: light does not notice it
    float eta[3];        // indices of the viewer's side over those of the other, for red, green and blue
};
// `channel`: 0, or 1 to 3 of light that was dispersed. Who starts within a medium is not known to be there; thin
// surfaces have air on both sides.
inline Boundary boundary(const Media& media, std::uint32_t m, bool entering, int channel,
                         const MaterialView* materials) {
    std::uint32_t before = kNoMedium, after = m;
    Boundary b;
    if (!materials[m].thin) {
        before = !entering && !media.has(m) ? m : media.current(materials);
        after = media.beyond(m, entering).current(materials);
        b.clear = before == after;
    }
    const auto ior = [&](std::uint32_t medium, int c) { return medium == kNoMedium ? 1.0f : materials[medium].ior[c]; };
    for (int c = 0; c < 3; ++c) {
        const int of = channel == 0 ? c : channel - 1;
        b.eta[c] = ior(before, of) / ior(after, of);
    }
    return b;
}

// Whether the material is that of a body that takes light on its way through.
inline bool absorbs(const MaterialView& m) {
    return may_transmit(m) && !m.thin && (m.absorption[0] > 0 || m.absorption[1] > 0 || m.absorption[2] > 0);
}

// What bodies take of light on a straight way to its lamp: a sum over their surfaces there. Bodies within bodies count
// as if both filled the space.
class StraightAbsorption {
  public:
    void cross(const MaterialView& m, bool leaving, float distance) {
        const Vec3T<float> a = Vec3T<float>::load(m.absorption) * (leaving ? 1.0f : -1.0f);
        depth_ = depth_ + a * distance;
        open_ = open_ - a;
    }
    // `length` of the whole way: a lamp may stand within a body.
    Vec3T<float> left(float length) const {
        constexpr float kWithoutEnd = 1e30f;
        const auto part = [&](float depth, float open) {
            const float rest = length < kWithoutEnd ? max(open, 0.0f) * length : 0.0f;
            return math::exp(-max(depth + rest, 0.0f));
        };
        return {part(depth_.x, open_.x), part(depth_.y, open_.y), part(depth_.z, open_.z)};
    }

  private:
    Vec3T<float> depth_{0, 0, 0}, open_{0, 0, 0};  // optical depth; absorption by bodies that were not left
};

}  // namespace tessera
