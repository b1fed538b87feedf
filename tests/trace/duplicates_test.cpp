// Duplicates against the definition: all pairs of triangles.
#include "trace/duplicates.h"

#include "geometry/support.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

struct Soup {
    std::vector<float> positions;
    std::vector<std::uint32_t> triangles;
    std::uint8_t front, back;

    TriangleSet set() const {
        return {positions.data(),
                triangles.data(),
                static_cast<std::uint32_t>(positions.size() / 3),
                static_cast<std::uint32_t>(triangles.size() / 3),
                front,
                back};
    }
    const float* corner(std::size_t t, std::size_t i) const {
        return positions.data() + 3 * std::size_t{triangles[3 * t + i]};
    }
};

bool same_point(const float* a, const float* b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

// 1: in the same place, -1: and turned over, 0: elsewhere.
int relation(const Soup& a, std::size_t s, const Soup& b, std::size_t t) {
    for (std::size_t r = 0; r < 3; ++r) {
        bool same = true, turned = true;
        for (std::size_t i = 0; i < 3; ++i) {
            same &= same_point(a.corner(s, i), b.corner(t, (i + r) % 3));
            turned &= same_point(a.corner(s, i), b.corner(t, (r + 3 - i) % 3));
        }
        if (same || turned) return same ? 1 : -1;
    }
    return 0;
}

std::vector<std::vector<std::uint32_t>> by_definition(const std::vector<Soup>& soups) {
    std::vector<std::vector<std::uint32_t>> dropped(soups.size());
    bool any = false;
    for (std::size_t b = 0; b < soups.size(); ++b) {
        for (std::size_t t = 0; t < soups[b].triangles.size() / 3; ++t) {
            unsigned front = 0, back = 0;  // by whom the sides are seen, of earlier ones
            for (std::size_t a = 0; a <= b; ++a) {
                for (std::size_t s = 0; s < (a < b ? soups[a].triangles.size() / 3 : t); ++s) {
                    const int r = relation(soups[a], s, soups[b], t);
                    if (r == 0) continue;
                    front |= r > 0 ? soups[a].front : soups[a].back;
                    back |= r > 0 ? soups[a].back : soups[a].front;
                }
            }
            const bool counts = soups[b].front | soups[b].back;
            if (!counts || (soups[b].front & ~front) || (soups[b].back & ~back)) continue;
            dropped[b].push_back(static_cast<std::uint32_t>(t));
            any = true;
        }
    }
    if (!any) dropped.clear();
    return dropped;
}

TEST(Duplicates, AreThoseOfTheDefinition) {
    Arena arena(2);
    for (std::uint32_t seed = 1; seed <= 300; ++seed) {
        test::Random random(seed);
        std::vector<Soup> soups(1 + random.below(4));
        const std::uint32_t values = 2 + random.below(3);
        for (Soup& soup : soups) {
            const std::uint32_t vertices = 3 + random.below(30);
            for (std::uint32_t i = 0; i < 3 * vertices; ++i) {
                const std::uint32_t v = random.below(values);
                soup.positions.push_back(v ? 0.1f * static_cast<float>(v) : (random.below(2) ? 0.0f : -0.0f));
            }
            for (std::uint32_t i = random.below(80); i > 0; --i) {
                std::uint32_t v[3];
                for (std::uint32_t& k : v) k = random.below(vertices);
                const float* p[3];
                for (std::size_t k = 0; k < 3; ++k) p[k] = &soup.positions[3 * std::size_t{v[k]}];
                if (same_point(p[0], p[1]) || same_point(p[1], p[2]) || same_point(p[2], p[0])) continue;
                soup.triangles.insert(soup.triangles.end(), v, v + 3);
            }
            soup.front = static_cast<std::uint8_t>(random.below(4));
            soup.back = static_cast<std::uint8_t>(random.below(4));
        }
        std::vector<TriangleSet> sets;
        for (const Soup& soup : soups) sets.push_back(soup.set());
        ASSERT_EQ(find_duplicates(sets, arena), by_definition(soups)) << "seed " << seed;
    }
}

TEST(Duplicates, NoneInNothing) {
    Arena arena(1);
    EXPECT_TRUE(find_duplicates({}, arena).empty());
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::uint32_t triangles[6] = {0, 1, 2, 2, 0, 1};
    const std::vector<TriangleSet> one{{positions, triangles, 3, 1, 1, 1}}, both{{positions, triangles, 3, 2, 1, 1}},
        sheer{{positions, triangles, 3, 2}};
    EXPECT_TRUE(find_duplicates(one, arena).empty());
    EXPECT_TRUE(find_duplicates(sheer, arena).empty());
    const std::vector<std::vector<std::uint32_t>> second(1, std::vector<std::uint32_t>(1, 1));
    EXPECT_EQ(find_duplicates(both, arena), second);
}

}  // namespace
}  // namespace tessera
