#include "reference/rasterizer.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tessera {
namespace {

// An edge of a triangle as a function of the position: E(x, y) = a x + b y + c, positive on the inner
// side, in units of 1/65536 square pixels. A sample on the edge belongs to the triangle when the edge
// is a left or a top one (with y down: going up, or level and going right), so that two triangles
// that share the edge never both own the sample and never both miss it. The two of a line may turn the rule.
struct Edge {
    std::int64_t a, b, c;

    // The triangle lies where E > 0 when its vertices run clockwise on the screen (y down), which is
    // the order that fill() brings them into.
    Edge(SnappedVertex from, SnappedVertex to, std::uint8_t ties) {
        const std::int64_t dx = static_cast<std::int64_t>(to.x) - from.x, dy = static_cast<std::int64_t>(to.y) - from.y;
        a = -dy;
        b = dx;
        c = -(a * from.x + b * from.y);
        if (!owns_edge(dx, dy, ties)) c -= 1;  // E > 0 as E - 1 >= 0: everything is an integer
    }
    bool inside(std::int64_t x, std::int64_t y) const { return a * x + b * y + c >= 0; }
};

// First pixel whose sample lies at or after `v`, and one past the last whose sample lies at or before
// it, for samples at 256 i + offset.
int first_sample(std::int32_t v, std::int32_t offset) { return (v - offset + 255) >> 8; }
int last_sample(std::int32_t v, std::int32_t offset) { return ((v - offset) >> 8) + 1; }

class Rasterizer {
  public:
    Rasterizer(const Frame& frame, const ShadingContext& context, SamplePosition offset, const RunControl& control)
        : frame_(frame), sampler_(frame, context), offset_(offset), control_(control) {
        out_.width = static_cast<int>(frame.projection.width);
        out_.height = static_cast<int>(frame.projection.height);
        const auto pixels = static_cast<std::size_t>(out_.width) * static_cast<std::size_t>(out_.height);
        out_.depth.assign(pixels, 0.0f);
        out_.triangle.assign(pixels, 0u);
    }

    Visibility run() {
        for (std::size_t i = 0; i < frame_.instances.size(); ++i) {
            const InstanceView& instance = frame_.instances[i];
            const std::uint32_t count = instance.mesh.triangle_count;
            out_.counters.triangles += count;
            if (outside_view(instance, frame_.prepared[i]->bounds)) {
                out_.counters.culled_frustum += count;
                continue;
            }
            for (std::uint32_t t = 0; t < count; ++t) {
                if (work_ > kWorkBetweenChecks) {
                    control_.checkpoint(static_cast<double>(instance.first_triangle + t) / frame_.triangle_count);
                    work_ = 0;
                }
                draw(instance, instance.first_triangle + t);
            }
        }
        sort_transparent(out_);
        return std::move(out_);
    }

  private:
    void draw(const InstanceView& instance, std::uint32_t triangle) {
        const TriangleSetup& t = sampler_.setup(triangle);
        work_ += 16;
        switch (t.kind) {
            case TriangleSetup::Kind::kOutside:
                ++out_.counters.culled_frustum;
                return;
            case TriangleSetup::Kind::kDegenerate:
                ++out_.counters.culled_degenerate;
                return;
            case TriangleSetup::Kind::kClipped:
                ++out_.counters.clipped;
                break;
            case TriangleSetup::Kind::kPlain:
                break;
        }
        const MaterialView& material = sampler_.material(triangle);
        if (!t.front(instance) && !material.double_sided) {
            ++out_.counters.culled_backface;
            return;
        }
        // A clipped polygon is a fan around its first vertex. Pieces that snapping has turned over (or
        // flattened) belong to nobody.
        for (int i = 1; i + 1 < t.vertex_count; ++i) {
            const std::int64_t area = twice_area(t.polygon[0], t.polygon[i], t.polygon[i + 1]);
            if (area == 0 || (area < 0) != (t.orientation > 0)) continue;
            const std::uint8_t ties = instance.mesh.tie_rule(triangle - instance.first_triangle);
            if (area < 0)
                fill({t.polygon[0], t.polygon[i + 1], t.polygon[i]}, ties, triangle, material.alpha_mode);
            else
                fill({t.polygon[0], t.polygon[i], t.polygon[i + 1]}, ties, triangle, material.alpha_mode);
        }
    }

    // Visits every sample of a triangle whose vertices run clockwise on the screen.
    void fill(const std::array<SnappedVertex, 3>& v, std::uint8_t ties, std::uint32_t triangle, AlphaMode mode) {
        const auto& [v0, v1, v2] = v;
        const Edge e0(v1, v2, ties), e1(v2, v0, ties), e2(v0, v1, ties);
        const int x_begin = std::max(first_sample(std::min({v0.x, v1.x, v2.x}), offset_.x), 0);
        const int y_begin = std::max(first_sample(std::min({v0.y, v1.y, v2.y}), offset_.y), 0);
        const int x_end = std::min(last_sample(std::max({v0.x, v1.x, v2.x}), offset_.x), out_.width);
        const int y_end = std::min(last_sample(std::max({v0.y, v1.y, v2.y}), offset_.y), out_.height);
        if (x_begin < x_end && y_begin < y_end) work_ += std::int64_t{x_end - x_begin} * (y_end - y_begin);
        for (int y = y_begin; y < y_end; ++y)
            for (int x = x_begin; x < x_end; ++x) {
                const SamplePosition at{256 * x + offset_.x, 256 * y + offset_.y};
                if (e0.inside(at.x, at.y) && e1.inside(at.x, at.y) && e2.inside(at.x, at.y))
                    cover(x, y, at, triangle, mode);
            }
    }

    // One covered sample: the depth test. Nearer wins; at equal depth the lower triangle number.
    void cover(int x, int y, SamplePosition at, std::uint32_t triangle, AlphaMode mode) {
        const std::size_t pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(out_.width) + static_cast<std::size_t>(x);
        const float z = sampler_.depth(triangle, at);
        if (!(z > 0.0f) || z < out_.depth[pixel]) return;
        if (z == out_.depth[pixel] && out_.triangle[pixel] != 0 && out_.triangle[pixel] <= triangle + 1) return;
        if (mode == AlphaMode::kBlend) {
            add_fragment(out_, {static_cast<std::uint32_t>(pixel), triangle, z}, control_);
            return;
        }
        if (mode == AlphaMode::kMask && sampler_.alpha(triangle, at) < sampler_.material(triangle).alpha_cutoff) return;
        out_.depth[pixel] = z;
        out_.triangle[pixel] = triangle + 1;
        ++out_.counters.fragments_passed;
    }

    const Frame& frame_;
    SurfaceSampler sampler_;
    SamplePosition offset_;
    const RunControl& control_;
    // Samples tested since the last checkpoint, a triangle's set-up counted as some.
    static constexpr std::int64_t kWorkBetweenChecks = 1 << 20;
    std::int64_t work_ = kWorkBetweenChecks + 1;
    Visibility out_;
};

}  // namespace

Visibility rasterize(const Frame& frame, const ShadingContext& context, SamplePosition offset,
                     const RunControl& control) {
    return Rasterizer(frame, context, offset, control).run();
}

}  // namespace tessera
