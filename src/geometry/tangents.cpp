#include "geometry/tangents.h"

#include "core/fp_environment.h"
#include "geometry/buckets.h"
#include "geometry/gather.h"
#include "geometry/matrix.h"
#include "geometry/triangles.h"
#include "geometry/weld.h"
#include "simd/math.h"

#include <tessera/error.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

namespace tessera {
namespace {

constexpr std::uint32_t kNothing = std::numeric_limits<std::uint32_t>::max();

constexpr std::uint32_t next_corner(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
constexpr std::uint32_t previous_corner(std::uint32_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

// v / |v|; zero for vectors of (nearly) no length, whose direction would be rounding noise.
glm::dvec3 unit(const glm::dvec3& v, double shortest = 0) {
    const double l = std::sqrt(glm::dot(v, v));
    return l > shortest ? v / l : glm::dvec3(0);
}

// The part of v in the plane with unit normal n, normalised.
glm::dvec3 unit_in_plane(const glm::dvec3& v, const glm::dvec3& n) {
    return unit(v - n * glm::dot(n, v), 1e-9 * std::sqrt(glm::dot(v, v)));
}

// Some unit vector perpendicular to n.
glm::dvec3 any_tangent(const glm::dvec3& n) {
    const glm::dvec3 axis = std::fabs(n.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return unit_in_plane(axis, n);
}

struct Mapping {
    glm::dvec3 tangent{0};       // dP/du of the triangle, unit length
    bool positive = false;       // sign of the uv area: triangles of one sign share tangents
    bool joins_any = true;       // no usable mapping: belongs to whichever group reaches it first
    bool is_degenerate = false;  // two corners in one place: takes no part, borrows its tangents
};

// The steps of the standard, over the corners 0 .. 3n-1 of n triangles.
class TangentSpace {
  public:
    TangentSpace(std::span<const Vec3> positions, std::span<const Vec3> normals, std::span<const Vec2> uv,
                 std::span<const std::uint32_t> corners)
        : positions_(positions),
          normals_(normals),
          uv_(uv),
          corners_(corners),
          corner_count_(static_cast<std::uint32_t>(corners.size())) {}

    std::vector<Vec4> compute() {
        weld();
        map_triangles();
        find_neighbours();
        build_groups();
        sum_groups();
        lend_to_ungrouped();
        return corner_results();
    }

  private:
    glm::dvec3 position(std::uint32_t corner) const { return to_dvec3(positions_[corners_[corner]]); }
    glm::dvec3 normal(std::uint32_t corner) const { return unit(to_dvec3(normals_[corners_[corner]])); }

    void weld() {
        const std::vector<std::uint32_t> representative = weld_vertices(positions_, normals_, uv_);
        welded_.resize(corner_count_);
        for (std::uint32_t c = 0; c < corner_count_; ++c) welded_[c] = representative[corners_[c]];
    }

    void map_triangles() {
        mappings_.resize(corner_count_ / 3);
        for (std::uint32_t t = 0; t < mappings_.size(); ++t) mappings_[t] = map_triangle(3 * t);
    }

    Mapping map_triangle(std::uint32_t c) const {
        Mapping m;
        const glm::dvec3 p = position(c), d1 = position(c + 1) - p, d2 = position(c + 2) - p;
        m.is_degenerate = d1 == glm::dvec3(0) || d2 == glm::dvec3(0) || d1 == d2;
        if (uv_.empty()) return m;
        const Vec2 a = uv_[corners_[c]], b = uv_[corners_[c + 1]], e = uv_[corners_[c + 2]];
        const double u1 = static_cast<double>(b.x) - a.x, v1 = static_cast<double>(b.y) - a.y;
        const double u2 = static_cast<double>(e.x) - a.x, v2 = static_cast<double>(e.y) - a.y;
        const double area = u1 * v2 - v1 * u2;  // twice the signed area in uv
        m.positive = area > 0;
        if (!(area != 0)) return m;
        // d1 = u1 dP/du + v1 dP/dv and d2 likewise, solved; the sign of the area is put back.
        const glm::dvec3 du = (d1 * v2 - d2 * v1) * (m.positive ? 1.0 : -1.0);
        const glm::dvec3 dv = d2 * u1 - d1 * u2;
        m.tangent = unit(du);
        m.joins_any = m.tangent == glm::dvec3(0) || dv == glm::dvec3(0);
        return m;
    }

    // Across each edge (from a corner to the next one) the triangle that has it in the other
    // direction. Where more than two triangles meet, the first of one direction takes the first of
    // the other that is still free, in the order of the corners.
    void find_neighbours() {
        neighbours_.assign(corner_count_, kNothing);
        const auto low = [&](std::uint32_t c) { return std::min(welded_[c], welded_[next_corner(c)]); };
        const auto high = [&](std::uint32_t c) { return std::max(welded_[c], welded_[next_corner(c)]); };
        Buckets edges = fill_buckets(corner_count_, positions_.size(), low);
        std::vector<std::uint32_t> waiting;  // edges of one direction without partner, first in first out
        for (std::size_t b = 0; b < edges.count(); ++b) {
            const std::span<std::uint32_t> bucket = edges[b];
            std::sort(bucket.begin(), bucket.end(),
                      [&](std::uint32_t i, std::uint32_t j) { return high(i) != high(j) ? high(i) < high(j) : i < j; });
            std::size_t served = 0;
            waiting.clear();
            for (std::size_t i = 0; i < bucket.size(); ++i) {
                const std::uint32_t c = bucket[i];
                if (mappings_[c / 3].is_degenerate) continue;
                if (served < waiting.size() && high(waiting[served]) != high(c)) served = waiting.size();
                if (served < waiting.size() && welded_[waiting[served]] != welded_[c]) {
                    neighbours_[c] = waiting[served] / 3;
                    neighbours_[waiting[served++]] = c / 3;
                } else {
                    waiting.push_back(c);
                }
            }
        }
    }

    // A group: the corners at one vertex whose triangles hang together by edges and have one
    // orientation.
    void build_groups() {
        group_.assign(corner_count_, kNothing);
        for (std::uint32_t c = 0; c < corner_count_; ++c) {
            const Mapping& m = mappings_[c / 3];
            if (!m.is_degenerate && !m.joins_any && group_[c] == kNothing) grow_group(c);
        }
    }

    void grow_group(std::uint32_t seed) {
        const std::uint32_t vertex = welded_[seed], group = group_count_++;
        const bool positive = mappings_[seed / 3].positive;
        group_positive_.push_back(positive);
        const auto take = [&](std::uint32_t corner) {
            group_[corner] = group;
            pending_.push_back(neighbours_[previous_corner(corner)]);
            pending_.push_back(neighbours_[corner]);  // taken off first
        };
        take(seed);
        while (!pending_.empty()) {
            const std::uint32_t t = pending_.back();
            pending_.pop_back();
            if (t == kNothing) continue;
            std::uint32_t corner = 3 * t;
            while (welded_[corner] != vertex) ++corner;  // a neighbour across an edge at `vertex` has it
            if (group_[corner] != kNothing) continue;
            Mapping& m = mappings_[t];
            // The first group to reach a triangle without mapping gives it its orientation.
            if (m.joins_any && group_[3 * t] == kNothing && group_[3 * t + 1] == kNothing &&
                group_[3 * t + 2] == kNothing)
                m.positive = positive;
            if (m.positive == positive) take(corner);
        }
    }

    void sum_groups() {
        sums_.assign(group_count_, glm::dvec3(0));
        for (std::uint32_t c = 0; c < corner_count_; ++c) {
            const Mapping& m = mappings_[c / 3];
            if (group_[c] == kNothing || m.joins_any) continue;
            const glm::dvec3 n = normal(c), p = position(c);
            const glm::dvec3 e1 = unit_in_plane(position(previous_corner(c)) - p, n);
            const glm::dvec3 e2 = unit_in_plane(position(next_corner(c)) - p, n);
            const double angle = math::acos(std::clamp(glm::dot(e1, e2), -1.0, 1.0));
            sums_[group_[c]] += unit_in_plane(m.tangent, n) * angle;
        }
    }

    // Corners of degenerate triangles, and those that no mapped triangle reached, take the first
    // group at their vertex.
    void lend_to_ungrouped() {
        std::vector<std::uint32_t> first_group(positions_.size(), kNothing);
        for (std::uint32_t c = corner_count_; c-- > 0;)
            if (group_[c] != kNothing) first_group[welded_[c]] = group_[c];
        for (std::uint32_t c = 0; c < corner_count_; ++c)
            if (group_[c] == kNothing) group_[c] = first_group[welded_[c]];
    }

    std::vector<Vec4> corner_results() const {
        std::vector<Vec4> result(corner_count_);
        for (std::uint32_t c = 0; c < corner_count_; ++c) {
            const std::uint32_t g = group_[c];
            glm::dvec3 t = g == kNothing ? glm::dvec3(0) : unit(sums_[g], 1e-9);
            if (t == glm::dvec3(0)) t = any_tangent(normal(c));
            const Vec3 xyz = to_vec3(t);
            // v points down in glTF, so a mapping of negative area is the right-handed one.
            const bool right_handed = g == kNothing || !group_positive_[g];
            result[c] = {xyz.x, xyz.y, xyz.z, right_handed ? 1.0f : -1.0f};
        }
        return result;
    }

    std::span<const Vec3> positions_, normals_;
    std::span<const Vec2> uv_;
    std::span<const std::uint32_t> corners_;
    std::uint32_t corner_count_, group_count_ = 0;
    std::vector<std::uint32_t> welded_;      // per corner: its vertex after welding
    std::vector<Mapping> mappings_;          // per triangle
    std::vector<std::uint32_t> neighbours_;  // per corner: the triangle across the edge that starts there
    std::vector<std::uint32_t> group_;       // per corner
    std::vector<bool> group_positive_;       // per group
    std::vector<glm::dvec3> sums_;           // per group: angle-weighted tangents
    std::vector<std::uint32_t> pending_;     // triangles that grow_group() still has to look at
};

using TangentBits = std::array<std::uint32_t, 4>;

TangentBits bits(const Vec4& t) { return std::bit_cast<TangentBits>(t); }

// Where the corners of a vertex have different tangents, appends copies of the vertex and redirects
// the corners. `corners` holds vertices before and after.
struct Split {
    std::vector<std::uint32_t> sources, corners;
    std::vector<Vec4> tangents;  // per vertex
};

Split split_vertices(std::size_t vertex_count, std::span<const std::uint32_t> corners, std::span<const Vec4> tangents) {
    Split split{std::vector<std::uint32_t>(vertex_count),
                {corners.begin(), corners.end()},
                std::vector<Vec4>(vertex_count, Vec4{1, 0, 0, 1})};
    std::iota(split.sources.begin(), split.sources.end(), 0u);
    Buckets at_vertex = fill_buckets(static_cast<std::uint32_t>(corners.size()), vertex_count,
                                     [&](std::uint32_t c) { return corners[c]; });
    for (std::uint32_t v = 0; v < vertex_count; ++v) {
        const std::span<std::uint32_t> own = at_vertex[v];
        if (own.empty()) continue;
        const TangentBits kept = bits(tangents[own[0]]);
        split.tangents[v] = tangents[own[0]];
        std::sort(own.begin(), own.end(), [&](std::uint32_t i, std::uint32_t j) {
            const TangentBits a = bits(tangents[i]), b = bits(tangents[j]);
            return a != b ? a < b : i < j;
        });
        for (std::size_t i = 0; i < own.size(); ++i) {
            const Vec4 t = tangents[own[i]];
            if (bits(t) == kept) continue;
            if (i == 0 || bits(tangents[own[i - 1]]) != bits(t)) {
                split.sources.push_back(v);
                split.tangents.push_back(t);
            }
            split.corners[own[i]] = static_cast<std::uint32_t>(split.sources.size() - 1);
        }
    }
    return split;
}

}  // namespace

std::vector<Vec4> corner_tangents(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                  std::span<const Vec2> uv, std::span<const std::uint32_t> triangles) {
    const FpEnvironment exact;
    if (triangles.size() >= kNothing || positions.size() >= kNothing)
        throw Error(ErrorCode::kLimit, "a primitive has too many vertices for tangents");
    return TangentSpace(positions, normals, uv, triangles.first(triangles.size() / 3 * 3)).compute();
}

Primitive with_tangents(const Primitive& primitive, int uv_set) {
    if (!has_triangles(primitive.mode) || primitive.normals.empty()) return primitive;
    const TriangleList triangles(primitive);
    if (triangles.empty()) return primitive;
    const auto set = static_cast<std::size_t>(uv_set);
    const bool has_uv = uv_set >= 0 && set < primitive.texcoords.size();
    const std::vector<Vec4> tangents = corner_tangents(
        primitive.positions, primitive.normals,
        has_uv ? std::span<const Vec2>(primitive.texcoords[set]) : std::span<const Vec2>{}, triangles.indices());
    Split split = split_vertices(primitive.positions.size(), triangles.indices(), tangents);
    Primitive result = gather_vertices(primitive, split.sources);
    result.tangents = std::move(split.tangents);
    result.indices = std::move(split.corners);
    return result;
}

}  // namespace tessera
