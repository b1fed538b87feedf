// Lines by their definition: which pixel centres a segment covers, against exact rational arithmetic and against the
// midpoint algorithm in integers, which knows nothing of triangles.
#include "raster/exactness.h"

#include <tessera/renderer.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <set>

namespace tessera {
namespace {

using namespace test;

struct Position {
    std::int64_t x, y;  // 1/256 pixel, y down
};
struct Line {
    Position from, to;
};
using Pixels = std::set<std::pair<int, int>>;  // y, x

// Exact for sizes that are powers of two.
Vec3 place(Position p, int width, int height) {
    return {static_cast<float>(p.x - 128 * width) / (128.0f * static_cast<float>(height)),
            1 - static_cast<float>(p.y) / (128.0f * static_cast<float>(height)), 0};
}

Scene scene_of(const std::vector<Line>& lines, int width, int height) {
    Primitive p;
    p.mode = PrimitiveMode::kLines;
    for (const Line& line : lines) {
        p.positions.push_back(place(line.from, width, height));
        p.positions.push_back(place(line.to, width, height));
    }
    Scene scene;
    add_mesh(scene, std::move(p));
    Camera camera;
    camera.type = Camera::Type::kOrthographic;
    camera.zfar = 20;
    camera.xmag = static_cast<float>(width) / static_cast<float>(height);
    scene.cameras.push_back(camera);
    Node node;
    node.camera = 0;
    node.translation = {0, 0, 10};
    scene.nodes.push_back(node);
    scene.scenes[0].nodes.push_back(1);
    return scene;
}

// What is drawn of a line, alone in the picture.
Pixels drawn(const Line& line, int width, int height, float line_width, Engine engine) {
    RenderOptions o;
    o.width = width, o.height = height;
    o.engine = engine;
    o.threads = 1;
    o.line_width = line_width;
    o.want_color = false;
    o.want_primitive = true;
    const RenderResult r = render(scene_of({line}, width, height), o);
    Pixels pixels;
    const auto* numbers = r.primitive.data<std::uint32_t>();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (numbers[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)])
                pixels.insert({y, x});
    return pixels;
}

// By definition: centres whose distance from the line along the minor axis is below half the width (`units` in 1/256
// pixel), half-way those that the line has not come to yet; along the major axis from the first end on, without the
// second.
Pixels defined(const Line& line, int width, int height, std::int64_t units) {
    Pixels pixels;
    std::int64_t dx = line.to.x - line.from.x, dy = line.to.y - line.from.y;
    const bool steep = std::abs(dy) > std::abs(dx);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::int64_t u = 256 * x + 128 - line.from.x, v = 256 * y + 128 - line.from.y, du = dx, dv = dy;
            if (steep) std::swap(u, v), std::swap(du, dv);
            if (du < 0) u = -u, du = -du;
            if (du == 0 || u < 0 || u >= du) continue;
            if (dv < 0) v = -v, dv = -dv;
            // v - u dv / du, twice and times du.
            const std::int64_t distance = 2 * (v * du - u * dv), half = units * du;
            if (distance >= -half && distance < half) pixels.insert({y, x});
        }
    return pixels;
}

// The midpoint algorithm from end to end, in steps of one pixel along the major axis (Foley et al., section 3.2.2),
// with ends anywhere on the grid of 1/256 pixel: E keeps the row, NE takes the next.
Pixels midpoint(const Line& line, int width, int height) {
    Pixels pixels;
    std::int64_t x = line.from.x, y = line.from.y, dx = line.to.x - x, dy = line.to.y - y;
    const bool steep = std::abs(dy) > std::abs(dx);
    if (steep) std::swap(x, y), std::swap(dx, dy);
    if (dx == 0) return pixels;
    // Turned into the first octant: mirrored coordinates of the grid.
    const bool back = dx < 0, up = dy < 0;
    if (back) x = -x, dx = -dx;
    if (up) y = -y, dy = -dy;
    const auto first_centre = [](std::int64_t v) { return ((v - 128 + 255) >> 8) * 256 + 128; };  // at or after
    std::int64_t column = first_centre(x);
    // The row whose centre is nearest to the line there, the lower one at a tie.
    const std::int64_t numerator = 2 * (y * dx + (column - x) * dy);  // over 2 dx
    std::int64_t row = first_centre(y - 128);
    while (2 * dx * (row + 128) < numerator) row += 256;
    // How far the midpoint between E and NE, at the next column, lies beyond the line: negative takes NE.
    std::int64_t d = 2 * dx * (row + 128) - (numerator + 2 * 256 * dy);
    for (; column < x + dx; column += 256) {
        std::int64_t px = back ? -column : column, py = up ? -row : row;
        if (steep) std::swap(px, py);
        if (px >= 0 && py >= 0 && px < 256 * width && py < 256 * height)
            pixels.insert({static_cast<int>(py >> 8), static_cast<int>(px >> 8)});
        if (d < 0) {
            row += 256;
            d += 2 * 256 * dx;
        }
        d -= 2 * 256 * dy;
    }
    return pixels;
}

// Of all octants and lengths; every other one on a coarse grid, where ties are frequent.
std::vector<Line> random_lines(int count, int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::int64_t n) { return static_cast<std::int64_t>(random() % static_cast<unsigned>(n)); };
    std::vector<Line> lines;
    for (int i = 0; i < count; ++i) {
        const std::int64_t grid = i % 2 == 0 ? 1 : i % 4 == 1 ? 128 : 64;
        const auto end = [&] { return Position{below(256 * width / grid) * grid, below(256 * height / grid) * grid}; };
        Line line{end(), end()};
        if (i % 3 == 0) {  // short
            line.to = {line.from.x + (below(24) - 12) * grid, line.from.y + (below(24) - 12) * grid};
            if (grid == 1) line.to = {line.from.x + below(2048) - 1024, line.from.y + below(2048) - 1024};
        }
        lines.push_back(line);
    }
    return lines;
}

std::string text(const Line& l) {
    return std::to_string(l.from.x) + "," + std::to_string(l.from.y) + " to " + std::to_string(l.to.x) + "," +
           std::to_string(l.to.y);
}

TEST(Lines, RAS3_WidthOfOneIsTheMidpointAlgorithm) {
    std::vector<Line> lines = random_lines(400, 64, 64, 7);
    // Level, upright and diagonal ones, both ways, at centres, borders and between.
    for (const std::int64_t a : {128, 256, 300})
        for (const std::int64_t b : {128 + 256 * 20, 256 * 20})
            for (const Line& l : {Line{{a, 2048}, {b, 2048}}, Line{{a, 2048 + 128}, {b, 2048 + 128}},
                                  Line{{2048, a}, {2048, b}}, Line{{a, a}, {b, b}}, Line{{a, b}, {b, a}}})
                lines.push_back(l), lines.push_back({l.to, l.from});
    for (const Line& line : lines) {
        const Pixels expected = midpoint(line, 64, 64);
        ASSERT_EQ(drawn(line, 64, 64, 1, Engine::kRaster), expected) << text(line);
        ASSERT_EQ(defined(line, 64, 64, 256), expected) << text(line);
        ASSERT_EQ(drawn(line, 64, 64, 1, Engine::kReferenceRaster), expected) << text(line);
    }
}

TEST(Lines, RAS3_LongLinesAreTheMidpointAlgorithm) {
    std::mt19937 random(11);
    for (int i = 0; i < 12; ++i) {
        const int width = i % 2 ? 4096 : 256, height = i % 2 ? 256 : 4096;
        const Line line = random_lines(1, width, height, static_cast<unsigned>(random()))[0];
        // From border to border, with ties and without.
        Line across = i % 2 ? Line{{128, line.from.y}, {256 * 4095 + 128, line.to.y}}
                            : Line{{line.from.x, 128}, {line.to.x, 256 * 4095 + 128}};
        if (i % 4 < 2) std::swap(across.from, across.to);
        if (i % 3 == 0) across.from.x &= ~127, across.to.x &= ~127, across.from.y &= ~127, across.to.y &= ~127;
        const Pixels expected = midpoint(across, width, height);
        EXPECT_GE(expected.size(), 4000u);
        EXPECT_EQ(drawn(across, width, height, 1, Engine::kRaster), expected) << text(across);
        EXPECT_EQ(drawn(across, width, height, 1, Engine::kReferenceRaster), expected) << text(across);
    }
}

TEST(Lines, RAS3_WiderOnesByDistanceFromTheLine) {
    for (const auto& [width, units] : {std::pair(2.0f, 512), std::pair(3.0f, 768), std::pair(2.5f, 640),
                                       std::pair(0.5f, 128), std::pair(17.0f, 17 * 256)})
        for (const Line& line : random_lines(120, 64, 64, static_cast<unsigned>(units))) {
            const Pixels expected = defined(line, 64, 64, units);
            ASSERT_EQ(drawn(line, 64, 64, width, Engine::kRaster), expected) << width << ": " << text(line);
            ASSERT_EQ(drawn(line, 64, 64, width, Engine::kReferenceRaster), expected) << width << ": " << text(line);
        }
}

// A loop of vertices at pixel centres, transparent: what is drawn twice would be less so.
TEST(Lines, RAS3_StripsAndLoopsDrawSharedEndsOnce) {
    for (const bool loop : {false, true})
        for (const bool backwards : {false, true}) {
            Scene scene = scene_of({}, 64, 64);
            Material m = unlit({1, 1, 1, 0.5f});
            m.alpha_mode = AlphaMode::kBlend;
            Primitive& p = scene.meshes[0].primitives[0];
            p.material = add_material(scene, m);
            p.mode = loop ? PrimitiveMode::kLineLoop : PrimitiveMode::kLineStrip;
            const int corners = 24;
            std::vector<Position> ends;
            for (int i = 0; i < corners; ++i) {
                const double angle = (backwards ? -1 : 1) * 2 * 3.14159265358979 * i / corners;
                ends.push_back({256 * static_cast<int>(32 + 28 * std::cos(angle)) + 128,
                                256 * static_cast<int>(32 + 28 * std::sin(angle)) + 128});
                p.positions.push_back(place(ends.back(), 64, 64));
            }
            for (const Engine engine : {Engine::kRaster, Engine::kReferenceRaster}) {
                RenderOptions o = all_planes(64, 64, 1);
                o.engine = engine;
                o.background.reset();
                const RenderResult r = render(scene, o);
                const float* linear = r.linear.data<float>();
                Pixels expected;
                for (int i = 0; i + 1 < corners + loop; ++i) {
                    const Pixels segment = midpoint({ends[i], ends[(i + 1) % corners]}, 64, 64);
                    expected.insert(segment.begin(), segment.end());
                }
                for (int y = 0; y < 64; ++y)
                    for (int x = 0; x < 64; ++x)
                        EXPECT_EQ(linear[4 * (64 * y + x) + 3], expected.count({y, x}) ? 0.5f : 0.0f) << x << "," << y;
                for (int i = 0; i < corners - !loop; ++i)
                    EXPECT_TRUE(expected.count({static_cast<int>(ends[i].y >> 8), static_cast<int>(ends[i].x >> 8)}));
                if (!loop) {  // the last end stays open
                    const Position last = ends.back();
                    EXPECT_FALSE(expected.count({static_cast<int>(last.y >> 8), static_cast<int>(last.x >> 8)}));
                }
            }
        }
}

// What is left out because it is outside was outside; the parts inside do not change.
TEST(Lines, RAS3_EndsOutsideOfThePicture) {
    for (Line line : random_lines(400, 192, 192, 3)) {
        for (Position* p : {&line.from, &line.to}) p->x -= 64 * 256, p->y -= 64 * 256;
        const Pixels expected = midpoint(line, 64, 64);
        ASSERT_EQ(drawn(line, 64, 64, 1, Engine::kRaster), expected) << text(line);
        ASSERT_EQ(drawn(line, 64, 64, 1, Engine::kReferenceRaster), expected) << text(line);
        ASSERT_EQ(drawn(line, 64, 64, 2.5f, Engine::kRaster), defined(line, 64, 64, 640)) << text(line);
    }
}

// Far outside lines are cut, and the ends snap anew: within 1/256 pixel of where they were.
TEST(Lines, RAS3_EndsFarOutsideAreCut) {
    std::size_t covered = 0;
    for (Line line : random_lines(200, 4096, 4096, 5)) {
        for (Position* p : {&line.from, &line.to}) p->x -= 2048 * 256, p->y -= 2048 * 256;
        const Pixels got = drawn(line, 64, 64, 2, Engine::kRaster);
        EXPECT_EQ(got, drawn(line, 64, 64, 2, Engine::kReferenceRaster)) << text(line);
        const Pixels least = defined(line, 64, 64, 512 - 4), most = defined(line, 64, 64, 512 + 4);
        EXPECT_TRUE(std::includes(got.begin(), got.end(), least.begin(), least.end())) << text(line);
        EXPECT_TRUE(std::includes(most.begin(), most.end(), got.begin(), got.end())) << text(line);
        covered += got.size();
    }
    EXPECT_GT(covered, 200u);
}

TEST(Lines, RAS3_WithoutLengthNothingIsDrawn) {
    for (const Position p : {Position{128, 128}, Position{256, 300}})
        for (const float width : {1.0f, 8.0f}) EXPECT_TRUE(drawn({p, p}, 16, 16, width, Engine::kRaster).empty());
}

}  // namespace
}  // namespace tessera
