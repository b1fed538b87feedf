// Which media lie on the two sides of a surface: by hand for glasses of water, and against intervals on a line, where
// what fills a place is plain to see.
#include "shading/media.h"

#include "shading/support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace tessera {
namespace {

using namespace test;

MaterialView medium(float ior, int priority, bool thin = false) {
    MaterialView m = plain_material(ShadingModel::kMetallicRoughness);
    m.transmission = 1;
    m.thin = thin;
    m.priority = priority;
    for (int i = 0; i < 3; ++i) m.ior[i] = ior + 0.01f * static_cast<float>(i - 1);
    return m;
}

// Water of low priority, glass, ice of the same priority as glass, a pane.
enum : std::uint32_t { kWater, kGlass, kIce, kPane };
const MaterialView kMaterials[] = {medium(1.33f, 0), medium(1.5f, 1), medium(1.31f, 1), medium(1.5f, 5, true)};

// A ray on its way: crosses surfaces and says what they are.
struct Way {
    Media media{};
    Boundary cross(std::uint32_t m, bool entering, int channel = 0) {
        const Boundary b = boundary(media, m, entering, channel, kMaterials);
        if (!kMaterials[m].thin) media = media.beyond(m, entering);
        return b;
    }
};
void expect_eta(const Boundary& b, float before, float after) {
    EXPECT_FALSE(b.clear);
    EXPECT_FLOAT_EQ(b.eta[1], before / after);
}

TEST(Media, InAndOutOfGlass) {
    Way way;
    expect_eta(way.cross(kGlass, true), 1, 1.5f);
    EXPECT_EQ(way.media.current(kMaterials), kGlass);
    expect_eta(way.cross(kGlass, false), 1.5f, 1);
    EXPECT_EQ(way.media.current(kMaterials), kNoMedium);
    EXPECT_EQ(way.media.count, 0);
}

TEST(Media, WaterThatReachesIntoItsGlassEndsAtTheGlass) {
    Way in;
    expect_eta(in.cross(kGlass, true), 1, 1.5f);
    EXPECT_TRUE(in.cross(kWater, true).clear);  // within the wall
    expect_eta(in.cross(kGlass, false), 1.5f, 1.33f);
    expect_eta(in.cross(kWater, false), 1.33f, 1);
    Way out;  // the other way: from the water
    expect_eta(out.cross(kWater, true), 1, 1.33f);
    expect_eta(out.cross(kGlass, true), 1.33f, 1.5f);
    EXPECT_TRUE(out.cross(kWater, false).clear);
    expect_eta(out.cross(kGlass, false), 1.5f, 1);
}

TEST(Media, OfEqualPriorityTheLastOneCounts) {
    Way way;
    expect_eta(way.cross(kGlass, true), 1, 1.5f);
    expect_eta(way.cross(kIce, true), 1.5f, 1.31f);
    EXPECT_TRUE(way.cross(kGlass, false).clear);
    expect_eta(way.cross(kIce, false), 1.31f, 1);
    Way nested;
    nested.cross(kGlass, true);
    expect_eta(nested.cross(kIce, true), 1.5f, 1.31f);
    expect_eta(nested.cross(kIce, false), 1.31f, 1.5f);
}

TEST(Media, BodiesOfOneMaterialThatOverlapAreOne) {
    Way way;
    expect_eta(way.cross(kGlass, true), 1, 1.5f);
    EXPECT_TRUE(way.cross(kGlass, true).clear);
    EXPECT_TRUE(way.cross(kGlass, false).clear);
    expect_eta(way.cross(kGlass, false), 1.5f, 1);
}

TEST(Media, WhoStartsWithinComesOut) {
    Way way;
    expect_eta(way.cross(kGlass, false), 1.5f, 1);
    EXPECT_EQ(way.media.count, 0);
    expect_eta(way.cross(kWater, true), 1, 1.33f);
}

TEST(Media, PanesHaveAirOnBothSides) {
    Way way;
    way.cross(kWater, true);
    for (const bool entering : {true, false}) expect_eta(way.cross(kPane, entering), 1, 1.5f);
    EXPECT_EQ(way.media.current(kMaterials), kWater);
}

TEST(Media, DispersedLightHasTheIndicesOfItsOwnColour) {
    const Boundary white = boundary({}, kGlass, true, 0, kMaterials);
    for (int channel = 1; channel <= 3; ++channel) {
        const Boundary b = boundary({}, kGlass, true, channel, kMaterials);
        EXPECT_FLOAT_EQ(white.eta[channel - 1], 1 / kMaterials[kGlass].ior[channel - 1]);
        for (const float eta : b.eta) EXPECT_EQ(eta, white.eta[channel - 1]);
    }
}

TEST(Media, MoreThanAreKeptDoNoHarm) {
    std::vector<MaterialView> many;
    for (int i = 0; i < Media::kMost + 3; ++i) many.push_back(medium(1.1f + 0.05f * static_cast<float>(i), i));
    Media media{};
    for (std::uint32_t i = 0; i < many.size(); ++i) media = media.beyond(i, true);
    EXPECT_EQ(media.count, Media::kMost);
    for (std::uint32_t i = 0; i < many.size(); ++i) media = media.beyond(i, false);
    EXPECT_EQ(media.count, 0);
}

// Bodies as intervals of a line. By definition the highest priority that is there fills a place, of equals the one
// that begins last.
TEST(Media, AlongALineTheBoundariesAreThoseOfWhatFillsIt) {
    Random random(1);
    int clear = 0, real = 0;
    for (int round = 0; round < 2000; ++round) {
        std::vector<MaterialView> materials;
        struct End {
            float at;
            std::uint32_t m;
            bool entering;
        };
        std::vector<float> begin, end;
        std::vector<End> ends;
        for (std::uint32_t m = 0; m < 5; ++m) {
            materials.push_back(medium(random.in(1.05f, 2), static_cast<int>(random.below(3))));
            const float a = random.in(0, 1), b = random.in(0, 1);
            begin.push_back(std::min(a, b)), end.push_back(std::max(a, b));
            ends.push_back({begin[m], m, true}), ends.push_back({end[m], m, false});
        }
        std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.at < b.at; });
        const auto fills = [&](float at) {
            std::uint32_t found = kNoMedium;
            for (std::uint32_t m = 0; m < 5; ++m) {
                if (!(begin[m] < at && at < end[m])) continue;
                if (found == kNoMedium || materials[m].priority > materials[found].priority ||
                    (materials[m].priority == materials[found].priority && begin[m] > begin[found]))
                    found = m;
            }
            return found;
        };
        const auto index = [&](std::uint32_t m) { return m == kNoMedium ? 1.0f : materials[m].ior[1]; };
        Media media{};
        for (std::size_t i = 0; i < ends.size(); ++i) {
            const float before = i == 0 ? -1.0f : (ends[i - 1].at + ends[i].at) / 2,
                        after = i + 1 == ends.size() ? 2.0f : (ends[i].at + ends[i + 1].at) / 2;
            const Boundary b = boundary(media, ends[i].m, ends[i].entering, 0, materials.data());
            EXPECT_EQ(b.clear, fills(before) == fills(after));
            EXPECT_FLOAT_EQ(b.eta[1], index(fills(before)) / index(fills(after)));
            media = media.beyond(ends[i].m, ends[i].entering);
            EXPECT_EQ(media.current(materials.data()), fills(after));
            ++(b.clear ? clear : real);
        }
    }
    EXPECT_GT(clear, 1000);
    EXPECT_GT(real, 1000);
}

}  // namespace
}  // namespace tessera
