#include "geometry/strokes.h"

#include "geometry/clip.h"
#include "geometry/matrix.h"
#include "simd/math.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

namespace tessera {
namespace {

void store_rows(const glm::dmat4& m, int rows, float* out) {
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < 4; ++c) out[4 * r + c] = static_cast<float>(m[c][r]);
}

std::int32_t units(float pixels) {
    return std::max(static_cast<std::int32_t>(static_cast<double>(pixels) * 256.0 + 0.5), 1);
}

// As many corners as it takes to stay within 1/8 pixel of the circle, inside and outside of it: a square up to two
// pixels, where that would show least, then a power of two.
std::vector<PictureOffset> disc(float size) {
    const std::int32_t whole = units(size), low = -(whole / 2), high = low + whole;
    if (size <= 2) return {{low, low}, {low, high}, {high, high}, {high, low}};
    const double radius = 0.5 * static_cast<double>(size);
    int count = 8;
    const auto sagitta = [&] { return 1 - math::cos(std::numbers::pi / count); };
    while (radius * sagitta() > 0.25) count *= 2;
    const double outer = 256.0 * radius * (1 + 0.5 * sagitta());
    std::vector<PictureOffset> corners;
    for (int i = 0; i < count; ++i) {
        const double angle = (2 * i + 1) * std::numbers::pi / count;
        const auto round = [](double v) { return static_cast<std::int32_t>(v < 0 ? v - 0.5 : v + 0.5); };
        corners.push_back({round(outer * math::cos(angle)), round(-outer * math::sin(angle))});
    }
    return corners;
}

float next_float(float value, bool up) {
    if (value == 0) return std::bit_cast<float>(up ? 1u : 0x80000001u);
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return std::bit_cast<float>((value > 0) == up ? bits + 1 : bits - 1);
}

// The x (or the y) of clip space that snaps to `target`. Rounding alone may miss it by one, at the far side of large
// pictures.
template <bool kX>
float unsnap(std::int32_t target, float w, float pixels) {
    const double half = 128.0 * static_cast<double>(pixels), aside = kX ? target - half : half - target;
    auto value = static_cast<float>(aside / half * static_cast<double>(w));
    for (int step = 0; step < 8; ++step) {
        const PictureVertex<float> p = to_picture(ClipVertex<float>{value, value, 0, w}, pixels, pixels);
        const std::int32_t snapped = kX ? p.snapped_x : p.snapped_y;
        if (snapped == target) break;
        value = next_float(value, (snapped < target) == kX);
    }
    return value;
}

}  // namespace

StrokeSpace::StrokeSpace(const FrameCamera& camera, const StrokeStyle& style)
    : width(camera.projection.width),
      height(camera.projection.height),
      orthographic(camera.projection.orthographic),
      inverse_scale(1 / camera.clip_scale) {
    // The rows of clip space that make the space: x, y and w, or z where w is 1.
    const glm::dmat4& clip = camera.camera_to_clip;
    const int third = orthographic ? 2 : 3;
    glm::dmat4 from_camera(1.0);
    for (int c = 0; c < 4; ++c) {
        from_camera[c].x = clip[c].x;
        from_camera[c].y = clip[c].y;
        from_camera[c].z = clip[c][third];
    }
    const glm::dmat4 camera_from_strokes = inverse_matrix(from_camera).value_or(glm::dmat4(0.0));
    glm::dmat4 m(1.0);
    if (!orthographic) {
        m = clip * camera_from_strokes;
        for (int c = 0; c < 4; ++c) {
            m[c].x = c == 0;
            m[c].y = c == 1;
            m[c].w = c == 2;
        }
    }
    store_rows(m, 4, to_clip);
    store_rows(camera_from_strokes, 3, to_camera);

    const std::int32_t whole = units(style.line_width);
    line_low = -(whole / 2);
    line_high = line_low + whole;
    corners = disc(style.point_size);
    // Vertices are to stay within the guard band of triangles, and on the grid in the largest pictures.
    const double aside = (static_cast<double>(style.line_width) + 2) / static_cast<double>(std::min(width, height));
    point_guard = 1 + (1.1 * static_cast<double>(style.point_size) + 4) / static_cast<double>(std::min(width, height));
    guard = std::clamp(3.25 - aside, 1.0, std::max(width, height) > 8192 ? 2.0 : 3.25);
}

// An end of a segment, or a point: where it is in clip space and in the picture.
struct StrokeMesh::End {
    HomogeneousPoint clip;
    PictureOffset at;
    float third;  // of the space's coordinates
    Source source;

    End(const ClipVertex<float>& v, std::uint32_t vertex)
        : clip{v.x, v.y, v.z, v.w}, at{}, third(0), source{vertex, vertex, 0} {}

    float w(const StrokeSpace& space) const { return space.orthographic ? 1.0f : third; }
    float x(const StrokeSpace& space, std::int32_t aside) const {
        return unsnap<true>(at.x + aside, w(space), space.width);
    }
    float y(const StrokeSpace& space, std::int32_t aside) const {
        return unsnap<false>(at.y + aside, w(space), space.height);
    }
    // False where it can be nowhere.
    bool place(const StrokeSpace& space) {
        const ClipVertex<float> v{static_cast<float>(clip.x), static_cast<float>(clip.y), static_cast<float>(clip.z),
                                  static_cast<float>(clip.w)};
        if (!(v.w > 0)) return false;
        const PictureVertex<float> p = to_picture(v, space.width, space.height);
        at = {p.snapped_x, p.snapped_y};
        third = static_cast<float>(space.orthographic ? clip.z / clip.w : clip.w * space.inverse_scale);
        return space.orthographic || third > 0;
    }
    // Moves to where the way to `inside` meets a plane.
    void cut(const End& inside, double t) {
        clip = lerp(inside.clip, clip, t);
        source.t = inside.source.t + (source.t - inside.source.t) * t;
    }
};

ClipVertex<float> StrokeMesh::clip_vertex(std::uint32_t vertex) const {
    const float* p = instance_->mesh.positions + 3 * std::size_t{vertex};
    return to_clip(instance_->object_to_clip, p[0], p[1], p[2]);
}

void StrokeMesh::add_vertex(float x, float y, const End& end) {
    const Vec3 p{x, y, end.third};
    bounds.add(p);
    positions_.insert(positions_.end(), {p.x, p.y, p.z});
    const Source& s = end.source;
    const auto add = [&s](std::vector<float>& out, const float* values, std::size_t numbers) {
        if (!values) return;
        const float *from = values + numbers * s.from, *to = values + numbers * s.to;
        for (std::size_t i = 0; i < numbers; ++i) {
            const double a = static_cast<double>(from[i]);
            out.push_back(s.t == 0 ? from[i] : static_cast<float>(a + (static_cast<double>(to[i]) - a) * s.t));
        }
    };
    const MeshView& mesh = instance_->mesh;
    add(normals_, mesh.normals, 3);
    add(colors_, mesh.colors, 4);
    for (int set = 0; set < kMaxUvSets; ++set) add(uvs_[set], mesh.uvs[set], 2);
}

void StrokeMesh::add_point(std::uint32_t element, std::uint32_t vertex, const StrokeSpace& space) {
    const ClipVertex<float> v = clip_vertex(vertex);
    if (!usable(v) || v.z > v.w) return;
    const double reach = space.point_guard * static_cast<double>(v.w);
    if (std::fabs(static_cast<double>(v.x)) > reach || std::fabs(static_cast<double>(v.y)) > reach) return;
    End end(v, vertex);
    if (!end.place(space)) return;
    PictureOffset low = end.at, high = end.at;
    for (const PictureOffset& c : space.corners) {
        low = {std::min(low.x, end.at.x + c.x), std::min(low.y, end.at.y + c.y)};
        high = {std::max(high.x, end.at.x + c.x), std::max(high.y, end.at.y + c.y)};
    }
    if (high.x < 0 || high.y < 0 || static_cast<float>(low.x) > 256 * space.width ||
        static_cast<float>(low.y) > 256 * space.height)
        return;
    const auto first = static_cast<std::uint32_t>(positions_.size() / 3);
    if (space.corners.size() == 4) {  // most often: a square, whose corners share coordinates
        const float x[2] = {end.x(space, space.corners[0].x), end.x(space, space.corners[2].x)};
        const float y[2] = {end.y(space, space.corners[0].y), end.y(space, space.corners[2].y)};
        add_vertex(x[0], y[0], end);
        add_vertex(x[0], y[1], end);
        add_vertex(x[1], y[1], end);
        add_vertex(x[1], y[0], end);
    } else {
        for (const PictureOffset& c : space.corners) add_vertex(end.x(space, c.x), end.y(space, c.y), end);
    }
    for (std::uint32_t i = 1; i + 1 < space.corners.size(); ++i) add_triangle(first, first + i, first + i + 1);
    elements_.push_back(element);
}

void StrokeMesh::add_segment(std::uint32_t element, std::uint32_t from, std::uint32_t to, const StrokeSpace& space) {
    const ClipVertex<float> v0 = clip_vertex(from), v1 = clip_vertex(to);
    if (!usable(v0) || !usable(v1)) return;
    End a(v0, from), b(v1, to);
    a.source = {from, to, 0};
    b.source = {from, to, 1};
    for (int plane = 0; plane < 5; ++plane) {
        const double da = guard_distance(a.clip, plane, space.guard), db = guard_distance(b.clip, plane, space.guard);
        if (da < 0 && db < 0) return;
        if (da < 0) a.cut(b, db / (db - da));
        if (db < 0) b.cut(a, da / (da - db));
    }
    if (!a.place(space) || !b.place(space)) return;
    const std::int32_t dx = b.at.x - a.at.x, dy = b.at.y - a.at.y;
    if (dx == 0 && dy == 0) return;
    const bool x_major = (dx < 0 ? -dx : dx) >= (dy < 0 ? -dy : dy);
    const PictureOffset low = x_major ? PictureOffset{0, space.line_low} : PictureOffset{space.line_low, 0};
    const PictureOffset high = x_major ? PictureOffset{0, space.line_high} : PictureOffset{space.line_high, 0};
    if (std::max(a.at.x, b.at.x) + high.x < 0 || std::max(a.at.y, b.at.y) + high.y < 0 ||
        static_cast<float>(std::min(a.at.x, b.at.x) + low.x) > 256 * space.width ||
        static_cast<float>(std::min(a.at.y, b.at.y) + low.y) > 256 * space.height)
        return;
    const auto first = static_cast<std::uint32_t>(positions_.size() / 3);
    for (const End* end : {&a, &b}) {
        const float x = end->x(space, low.x), y = end->y(space, low.y);
        const float far_x = x_major ? x : end->x(space, high.x), far_y = x_major ? end->y(space, high.y) : y;
        const bool second = end == &b;  // around the parallelogram
        add_vertex(second ? far_x : x, second ? far_y : y, *end);
        add_vertex(second ? x : far_x, second ? y : far_y, *end);
    }
    const std::uint32_t turned = (x_major ? dx < 0 : dy > 0) ? 1 : 0;  // so that a viewer sees all fronts
    add_triangle(first, first + 1 + turned, first + 2 - turned);
    add_triangle(first, first + 2 + turned, first + 3 - turned);
    elements_.push_back(element);
    ties_.push_back(
        static_cast<std::uint8_t>((dx < 0 ? kTieLeft : 0) | (dy < 0 ? kTieUp : 0) | (x_major ? kTieDownFirst : 0)));
}

void StrokeMesh::clear() {
    for (std::vector<float>* v : {&positions_, &normals_, &colors_}) v->clear();
    for (std::vector<float>& uv : uvs_) uv.clear();
    triangles_.clear();
    elements_.clear();
    ties_.clear();
    bounds = {};
}

void StrokeMesh::make(const InstanceView& instance, const PreparedMesh& mesh, std::uint32_t first, std::uint32_t count,
                      const StrokeSpace& space) {
    clear();
    instance_ = &instance;
    stroke_of = &mesh;
    const bool points = mesh.primitive().mode == PrimitiveMode::kPoints;
    for (std::uint32_t e = first; e < first + count; ++e) {
        const auto [from, to] = stroke_vertices(mesh.primitive(), e);
        if (points)
            add_point(e, from, space);
        else
            add_segment(e, from, to, space);
    }
    set_view(points ? static_cast<std::uint32_t>(space.corners.size()) - 2 : 2, !points);
    instance_ = nullptr;
}

void StrokeMesh::set_view(std::uint32_t triangles_per_element, bool lines) {
    const auto floats = [](const std::vector<float>& v) { return v.empty() ? nullptr : v.data(); };
    view = {};
    view.positions = floats(positions_);
    view.normals = floats(normals_);
    view.colors = floats(colors_);
    for (int set = 0; set < kMaxUvSets; ++set) view.uvs[set] = floats(uvs_[set]);
    view.triangles = triangles_.data();
    view.triangle_count = static_cast<std::uint32_t>(triangles_.size() / 3);
    view.vertex_count = static_cast<std::uint32_t>(positions_.size() / 3);
    view.elements = elements_.data();
    view.triangles_per_element = triangles_per_element;
    view.ties = lines ? ties_.data() : nullptr;
    lowest_vertex = 0;
    highest_vertex = view.vertex_count > 0 ? view.vertex_count - 1 : 0;
}

std::uint64_t StrokeMesh::bytes() const {
    std::size_t numbers = positions_.size() + normals_.size() + colors_.size() + triangles_.size() + elements_.size();
    for (const std::vector<float>& uv : uvs_) numbers += uv.size();
    return 4 * numbers + ties_.size();
}

}  // namespace tessera
