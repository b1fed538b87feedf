// Triangles for spheres, discs and planes. Computed in double without libm and rounded once.
#include "scene/shapes.h"

#include <tessera/error.h>
#include <tessera/scene.h>

#include "core/fp_environment.h"
#include "simd/math.h"

#include <string>

namespace tessera {
namespace {

// Rings of a plane without end: the half side of the squares between them doubles from 1 to kPlaneReach.
constexpr int kPlaneRings = 24;
static_assert(kPlaneReach == static_cast<float>(1 << kPlaneRings));

bool is_above_zero(float x) { return x > 0 && x - x == 0; }

// Rings of triangles from pole to pole of a sphere.
int ring_count(const Shape& sphere) { return sphere.segments / 2; }

struct Direction {
    double sine, cosine;
};

// Of the angle of k / n turns, exact at quarters: seams close, and poles and axes are where they should be.
Direction direction(int k, int n) {
    const int quarter = 4 * k / n;
    const double rest = 0.5 * math::kPi<double> * (4 * k - quarter * n) / n;
    const double s = math::sin(rest), c = math::cos(rest);
    switch (quarter % 4) {
        case 0:
            return {s, c};
        case 1:
            return {c, -s};
        case 2:
            return {-s, -c};
        default:
            return {-c, s};
    }
}

// Without a negative zero.
float rounded(double x) { return static_cast<float>(x) + 0.0f; }
Vec3 rounded(double x, double y, double z) { return {rounded(x), rounded(y), rounded(z)}; }

// A primitive that grows vertex by vertex.
class Builder {
  public:
    Builder(const Shape& shape, int material) {
        const ShapeCounts counts = shape_counts(shape);
        const auto vertices = static_cast<std::size_t>(counts.vertices);
        p_.shape = shape;
        p_.material = material;
        p_.texcoords.resize(1);
        p_.positions.reserve(vertices);
        p_.normals.reserve(vertices);
        p_.tangents.reserve(vertices);
        p_.texcoords[0].reserve(vertices);
        p_.indices.reserve(3 * static_cast<std::size_t>(counts.triangles));
    }
    void add_vertex(Vec3 position, Vec3 normal, Vec3 along_u, double u, double v) {
        p_.positions.push_back(position);
        p_.normals.push_back(normal);
        p_.tangents.push_back({along_u.x, along_u.y, along_u.z, 1});  // v grows against cross(normal, along_u)
        p_.texcoords[0].push_back({rounded(u), rounded(v)});
    }
    // Of discs and planes.
    void add_flat_vertex(double x, double z, double u, double v) {
        add_vertex(rounded(x, 0, z), {0, 1, 0}, {1, 0, 0}, u, v);
    }
    void add_triangle(int a, int b, int c) {
        for (const int vertex : {a, b, c}) p_.indices.push_back(static_cast<std::uint32_t>(vertex));
    }
    void add_quad(int a, int b, int c, int d) {
        add_triangle(a, b, c);
        add_triangle(a, c, d);
    }
    Primitive take() { return std::move(p_); }

  private:
    Primitive p_;
};

// A row of vertices below the other from the north pole down. At the poles each sector has a vertex of its own, with
// the u of its middle.
void build_sphere(const Shape& shape, Builder& builder) {
    const int n = shape.segments, rings = ring_count(shape);
    const double r = static_cast<double>(shape.radius);
    // Column `k` of `columns`, row `i` of the rings.
    const auto add = [&](int i, int k, int columns) {
        const Direction down = direction(i, 2 * rings), around = direction(k, columns);
        const double x = -down.sine * around.sine, y = down.cosine, z = -down.sine * around.cosine;
        builder.add_vertex(rounded(r * x, r * y, r * z), rounded(x, y, z), rounded(-around.cosine, 0, around.sine),
                           static_cast<double>(k) / columns, static_cast<double>(i) / rings);
    };
    const auto add_pole = [&](int i) {
        for (int k = 0; k < n; ++k) add(i, 2 * k + 1, 2 * n);
    };
    add_pole(0);
    for (int i = 1; i < rings; ++i)
        for (int k = 0; k <= n; ++k) add(i, k, n);
    add_pole(rings);

    const auto vertex = [&](int i, int k) { return n + (i - 1) * (n + 1) + k; };
    for (int k = 0; k < n; ++k) builder.add_triangle(k, vertex(1, k), vertex(1, k + 1));
    for (int i = 1; i + 1 < rings; ++i)
        for (int k = 0; k < n; ++k)
            builder.add_quad(vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1), vertex(i, k + 1));
    for (int k = 0; k < n; ++k) builder.add_triangle(vertex(rings, k), vertex(rings - 1, k + 1), vertex(rings - 1, k));
}

void build_disc(const Shape& shape, Builder& builder) {
    const int n = shape.segments;
    const double r = static_cast<double>(shape.radius);
    builder.add_flat_vertex(0, 0, 0.5, 0.5);
    for (int k = 0; k < n; ++k) {
        const Direction d = direction(k, n);
        builder.add_flat_vertex(r * d.sine, r * d.cosine, 0.5 + 0.5 * d.sine, 0.5 + 0.5 * d.cosine);
    }
    for (int k = 0; k < n; ++k) builder.add_triangle(0, 1 + k, 1 + (k + 1) % n);
}

void build_rectangle(const Shape& shape, Builder& builder) {
    const double x = 0.5 * static_cast<double>(shape.size.x), z = 0.5 * static_cast<double>(shape.size.y);
    builder.add_flat_vertex(-x, -z, 0, 0);
    builder.add_flat_vertex(-x, z, 0, 1);
    builder.add_flat_vertex(x, z, 1, 1);
    builder.add_flat_vertex(x, -z, 1, 0);
    builder.add_quad(0, 1, 2, 3);
}

// Squares in each other, and between two of them four trapezoids. No facet is much larger than its distance from the
// middle, so that near ones are precise.
void build_endless_plane(Builder& builder) {
    for (int ring = 0; ring <= kPlaneRings; ++ring) {
        const double h = 1 << ring;
        builder.add_flat_vertex(-h, -h, -h, -h);
        builder.add_flat_vertex(-h, h, -h, h);
        builder.add_flat_vertex(h, h, h, h);
        builder.add_flat_vertex(h, -h, h, -h);
    }
    builder.add_quad(0, 1, 2, 3);
    for (int ring = 0; ring < kPlaneRings; ++ring) {
        const int inner = 4 * ring, outer = inner + 4;
        for (int k = 0; k < 4; ++k) {
            const int next = (k + 1) % 4;
            builder.add_quad(outer + k, outer + next, inner + next, inner + k);
        }
    }
}

}  // namespace

std::optional<ShapeFault> find_fault(const Shape& shape) {
    if (shape.type == Shape::Type::kPlane) {
        if (!is_endless(shape) && !(is_above_zero(shape.size.x) && is_above_zero(shape.size.y)))
            return ShapeFault{"size", "must be finite and above 0"};
        return {};
    }
    if (!is_above_zero(shape.radius)) return ShapeFault{"radius", "must be finite and above 0"};
    if (shape.segments < 8 || shape.segments > 1024) return ShapeFault{"segments", "must be 8 to 1024"};
    return {};
}

ShapeCounts shape_counts(const Shape& shape) {
    const auto n = static_cast<std::uint64_t>(shape.segments), rows = n / 2 - 1;  // without the poles
    switch (shape.type) {
        case Shape::Type::kSphere:
            return {2 * n + rows * (n + 1), 2 * n * rows};
        case Shape::Type::kDisc:
            return {n + 1, n};
        case Shape::Type::kPlane:
            break;
    }
    const std::uint64_t rings = is_endless(shape) ? kPlaneRings : 0;
    return {4 + 4 * rings, 2 + 8 * rings};
}

Primitive shape_primitive(const Shape& shape, int material) {
    const FpEnvironment exact;
    if (const std::optional<ShapeFault> fault = find_fault(shape))
        throw Error(ErrorCode::kUsage, std::string(fault->message), "", "shape/" + std::string(fault->field));
    Builder builder(shape, material);
    switch (shape.type) {
        case Shape::Type::kSphere:
            build_sphere(shape, builder);
            break;
        case Shape::Type::kDisc:
            build_disc(shape, builder);
            break;
        case Shape::Type::kPlane:
            is_endless(shape) ? build_endless_plane(builder) : build_rectangle(shape, builder);
            break;
    }
    return builder.take();
}

}  // namespace tessera
