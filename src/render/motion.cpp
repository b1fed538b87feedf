#include "render/motion.h"

#include "geometry/matrix.h"
#include "shading/shape_surface.h"
#include "shading/triangle_setup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace tessera {
namespace {

constexpr std::uint32_t kNoInstance = 0xffffffffu;

glm::dvec4 clip_position(const glm::dmat4& m, const float* p) {
    return m * glm::dvec4(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]), 1.0);
}

// The instances of one shot in another one.
struct Moved {
    std::vector<std::uint32_t> instance;  // kNoInstance where it is not drawn there
    std::vector<char> stands;             // no vertex of it is elsewhere

    Moved(const Frame& now, const OtherShot& other) {
        std::size_t first = 0;  // of the same node, as both are in the order of the nodes
        const std::vector<std::uint32_t>& nodes = other.frame.node_of_instance;
        for (std::size_t i = 0; i < now.instances.size(); ++i) {
            const std::uint32_t node = now.node_of_instance[i];
            while (first < nodes.size() && nodes[first] < node) ++first;
            std::uint32_t found = kNoInstance;
            for (std::size_t j = first; j < nodes.size() && nodes[j] == node && found == kNoInstance; ++j)
                if (&prepared_mesh(*other.frame.prepared[j]) == &prepared_mesh(*now.prepared[i]))
                    found = static_cast<std::uint32_t>(j);
            instance.push_back(found);
            const bool same_place =
                node < other.frame.node_to_clip.size() && other.frame.node_to_clip[node] == now.node_to_clip[node];
            stands.push_back(same_place && !prepared_mesh(*now.prepared[i]).deformed);
        }
    }
};

// A triangle at the other shot, in its picture.
class OtherTriangles {
  public:
    OtherTriangles(const OtherShot& other, const MaterialView* materials) : other_(other), materials_(materials) {}

    // Whether a surface of its own depth at `q` (1/256 pixel) is to be seen: nothing that the pixels around it show
    // covers it and is nearer. Where none of it covers it, what the nearest pixel shows stands for what is between.
    bool sees(std::uint32_t triangle, SamplePosition q) {
        const ProjectionView& p = other_.frame.projection;
        const int width = static_cast<int>(p.width), height = static_cast<int>(p.height);
        const TriangleSetup own = setup(triangle);
        const InstanceView& instance = other_.frame.instance_of(triangle);
        if (!own.visible() || !(own.front(instance) || materials_[instance.material].double_sided)) return false;
        const float depth = own.depth.at(q.x, q.y);
        if (!(depth > 0)) return false;
        const int left = (q.x - 128) >> 8, top = (q.y - 128) >> 8;
        const int nearest_x = q.x >> 8, nearest_y = q.y >> 8;
        bool covered = false;
        std::optional<std::uint32_t> nearest;
        for (int y = std::max(top, 0); y <= std::min(top + 1, height - 1); ++y)
            for (int x = std::max(left, 0); x <= std::min(left + 1, width - 1); ++x) {
                const std::uint32_t number = other_.seen[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                                         static_cast<std::size_t>(x)];
                if (x == nearest_x && y == nearest_y) nearest = number;
                if (number == 0) continue;
                const TriangleSetup& t = setup(number - 1);
                if (number - 1 != triangle && !covers(t, q)) continue;
                covered = true;
                // Neighbours of a surface meet it where snapping to 1/256 pixel says.
                if (number - 1 != triangle && t.depth.at(q.x, q.y) > depth + slack(own, 2) + slack(t, 2)) return false;
            }
        if (covered || !nearest || *nearest == 0) return true;
        const TriangleSetup& t = setup(*nearest - 1);
        return t.depth.at(q.x, q.y) <= depth + slack(own, 256) + slack(t, 256);
    }

    // The same for a point at `q` that has no surface around it, of a point or line of that number in the scene:
    // whether the pixel shows itself, or nothing that is nearer. `front`: of shapes, the side that has to be shown.
    bool sees_point(std::uint32_t primitive, float depth, SamplePosition q, std::optional<bool> front = {}) {
        const auto width = static_cast<std::size_t>(other_.frame.projection.width);
        const std::uint32_t number =
            other_.seen[static_cast<std::size_t>(q.y >> 8) * width + static_cast<std::size_t>(q.x >> 8)];
        if (number == 0) return true;
        const InstanceView& instance = other_.frame.instance_of(number - 1);
        const TriangleSetup& t = setup(number - 1);
        if (instance.first_primitive + instance.mesh.element_of(number - 1 - instance.first_triangle) == primitive)
            return !front || *front == t.front(instance);
        return t.depth.at(q.x, q.y) <= depth + slack(t, 256) + 1e-6f * depth;
    }

  private:
    // How much depth may change over so many 1/256 pixels, and by rounding.
    static float slack(const TriangleSetup& t, float steps) {
        return steps * (std::fabs(t.depth.ddx) + std::fabs(t.depth.ddy)) + 1e-6f * t.depth.highest;
    }

    static bool covers(const TriangleSetup& t, SamplePosition q) {
        bool left = false, right = false;
        for (int i = 0; i < t.vertex_count; ++i) {
            const std::int64_t side =
                twice_area(t.polygon[i], t.polygon[(i + 1) % t.vertex_count], SnappedVertex{q.x, q.y});
            left |= side < 0;
            right |= side > 0;
        }
        return !(left && right);
    }

    // The latest few are remembered: neighbouring pixels show the same ones.
    const TriangleSetup& setup(std::uint32_t triangle) {
        Entry& entry = entries_[triangle % kEntries];
        if (entry.triangle != triangle) {
            entry.triangle = triangle;
            const InstanceView& instance = other_.frame.instance_of(triangle);
            setup_triangle(instance, triangle - instance.first_triangle, other_.frame.projection, entry.setup);
        }
        return entry.setup;
    }

    static constexpr std::uint32_t kEntries = 64;
    struct Entry {
        std::uint32_t triangle = 0xffffffffu;
        TriangleSetup setup;
    };
    const OtherShot& other_;
    const MaterialView* materials_;
    std::vector<Entry> entries_{kEntries};
};

// Barycentric coordinates of the point of a triangle that is seen at (x, y) of normalised device coordinates. A sample
// that only snapping put inside gets a point nearby, which `moved` then says. False for a triangle that is seen edge
// on.
bool barycentrics(const glm::dvec4 (&v)[3], double x, double y, double (&b)[3], bool& moved) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec4 &j = v[(i + 1) % 3], &k = v[(i + 2) % 3];
        b[i] = x * (j.y * k.w - j.w * k.y) + y * (j.w * k.x - j.x * k.w) + (j.x * k.y - j.y * k.x);
        sum += b[i];
    }
    if (!(std::fabs(sum) > 0)) return false;
    double inside = 0;
    moved = false;
    for (double& part : b) {
        part /= sum;
        if (!(part > 0)) {
            moved = moved || part != 0;
            part = 0;
        }
        inside += part;
    }
    if (!(inside > 0) || !(inside - inside == 0)) return false;
    for (double& part : b) part /= inside;
    return true;
}

// Motion of the pixels of a row towards one other shot.
class RowMotion {
  public:
    RowMotion(const Frame& now, const OtherShot& other, const Moved& moved, const MaterialView* materials)
        : now_(now), other_(other), moved_(moved), materials_(materials), triangles_(other, materials) {}

    // Writes x and y to `vector`; returns whether the point is seen there.
    bool measure(std::uint32_t triangle, int x, int y, float* vector) {
        find(triangle);
        if (stroke_) return measure_stroke(x + 0.5, y + 0.5, vector);
        if (shape_) return measure_shape(x, y, vector);
        if (stands_) return sees({256 * x + 128, 256 * y + 128});
        const double px = x + 0.5, py = y + 0.5;
        const double w = static_cast<double>(now_.projection.width), h = static_cast<double>(now_.projection.height);
        double b[3];
        bool moved = false;
        if (!barycentrics(here_, 2 * px / w - 1, 1 - 2 * py / h, b, moved)) return false;
        const glm::dvec4 p = there_[0] * b[0] + there_[1] * b[1] + there_[2] * b[2];
        const double qx = (p.x / p.w + 1) * 0.5 * w, qy = (1 - p.y / p.w) * 0.5 * h;
        if (!(p.w > 0) || !(std::fabs(qx) < 1e7 && std::fabs(qy) < 1e7)) return false;
        double from_x = px, from_y = py;
        if (moved) {
            const glm::dvec4 from = here_[0] * b[0] + here_[1] * b[1] + here_[2] * b[2];
            if (!(from.w > 0)) return false;
            from_x = (from.x / from.w + 1) * 0.5 * w, from_y = (1 - from.y / from.w) * 0.5 * h;
        }
        vector[0] = static_cast<float>(qx - from_x);
        vector[1] = static_cast<float>(qy - from_y);
        const bool inside = qx >= 0 && qx < w && qy >= 0 && qy < h && p.z <= p.w && p.z >= 0;
        return inside && sees({static_cast<std::int32_t>(qx * 256), static_cast<std::int32_t>(qy * 256)});
    }

  private:
    // The point of the formula, which moves with its node; the other shot shows the shape's triangles.
    bool measure_shape(int x, int y, float* vector) {
        const PictureRays rays(now_.projection);
        const float at_x = static_cast<float>(256 * x + 128), at_y = static_cast<float>(256 * y + 128);
        const ShapeHit<float> hit =
            hit_shape<float>(shape_->shape, picture_ray(now_.projection, rays, at_x, at_y), local_ == kLeavingSphere);
        const float position[3] = {hit.position.x, hit.position.y, hit.position.z};
        const glm::dvec4 to = clip_position(other_.frame.node_to_clip[node_], position);
        const double w = static_cast<double>(now_.projection.width), h = static_cast<double>(now_.projection.height);
        const double qx = stands_ ? x + 0.5 : (to.x / to.w + 1) * 0.5 * w,
                     qy = stands_ ? y + 0.5 : (1 - to.y / to.w) * 0.5 * h;
        if (!(to.w > 0) || !(std::fabs(qx) < 1e7 && std::fabs(qy) < 1e7)) return false;
        vector[0] = static_cast<float>(qx - (x + 0.5)), vector[1] = static_cast<float>(qy - (y + 0.5));
        const bool inside = qx >= 0 && qx < w && qy >= 0 && qy < h && to.z <= to.w && to.z >= 0;
        const bool front = faces_there(hit);
        return inside && (front || materials_[shape_->material].double_sided) &&
               triangles_.sees_point(primitive_, static_cast<float>(to.z / to.w),
                                     {static_cast<std::int32_t>(qx * 256), static_cast<std::int32_t>(qy * 256)}, front);
    }

    // Whether the shape's front is towards the eye of the other shot.
    bool faces_there(const ShapeHit<float>& hit) const {
        const auto wide = [](const Vec3T<float>& v) {
            return glm::dvec3(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
        };
        const glm::dvec3 n = wide(hit.normal);
        return glm::dot(n, glm::dvec3(eye_there_)) > glm::dot(n, wide(hit.position)) * eye_there_.w;
    }

    // Points move as their centres do, and what lines show as the points of the line beside it along the minor axis.
    bool measure_stroke(double px, double py, float* vector) {
        const double w = static_cast<double>(now_.projection.width), h = static_cast<double>(now_.projection.height);
        const double x = 2 * px / w - 1, y = 1 - 2 * py / h;
        const glm::dvec4 along = here_[1] - here_[0];
        const double per_x = along.x - x * along.w, per_y = along.y - y * along.w;
        const bool x_major = std::fabs(per_x) * w >= std::fabs(per_y) * h;
        const double per = x_major ? per_x : per_y;
        const double behind = x_major ? x * here_[0].w - here_[0].x : y * here_[0].w - here_[0].y;
        const double t = per != 0 ? std::clamp(behind / per, 0.0, 1.0) : 0.0;
        const glm::dvec4 from = here_[0] + along * t, to = there_[0] + (there_[1] - there_[0]) * t;
        if (!(from.w > 0 && to.w > 0)) return false;
        const double dx = stands_ ? 0 : (to.x / to.w - from.x / from.w) * 0.5 * w,
                     dy = stands_ ? 0 : (from.y / from.w - to.y / to.w) * 0.5 * h;
        const double qx = (to.x / to.w + 1) * 0.5 * w, qy = (1 - to.y / to.w) * 0.5 * h;
        if (!(std::fabs(qx) < 1e7 && std::fabs(qy) < 1e7)) return false;
        vector[0] = static_cast<float>(dx), vector[1] = static_cast<float>(dy);
        const bool inside = qx >= 0 && qx < w && qy >= 0 && qy < h && to.z <= to.w && to.z >= 0;
        return inside &&
               triangles_.sees_point(primitive_, static_cast<float>(to.z / to.w),
                                     {static_cast<std::int32_t>(qx * 256), static_cast<std::int32_t>(qy * 256)});
    }

    // One that is not drawn there is a duplicate: the one that is stands at the same place.
    bool sees(SamplePosition q) {
        return there_instance_ == kNoInstance ||
               triangles_.sees(other_.frame.instances[there_instance_].first_triangle + local_, q);
    }

    void find(std::uint32_t triangle) {
        if (triangle == triangle_) return;
        triangle_ = triangle;
        const InstanceView& instance = now_.instance_of(triangle);
        const auto i = static_cast<std::size_t>(&instance - now_.instances.data());
        local_ = triangle - instance.first_triangle;
        there_instance_ = moved_.instance[i];
        stands_ = moved_.stands[i] != 0;
        stroke_ = instance.mesh.is_stroke();
        shape_ = instance.shape ? &instance : nullptr;
        primitive_ = instance.first_primitive + instance.mesh.element_of(local_);
        const std::uint32_t node = node_ = now_.node_of_instance[i];
        if (shape_) {
            // In clip space eyes, near or infinitely far, are on the axis of depth.
            const std::optional<glm::dmat4> inverse = inverse_matrix(other_.frame.node_to_clip[node]);
            eye_there_ = inverse ? *inverse * glm::dvec4(0, 0, 1, 0) : glm::dvec4(0.0);
        }
        if (shape_ || (stands_ && !stroke_)) return;
        const PreparedMesh& mesh = prepared_mesh(*now_.prepared[i]);
        const float* const positions = other_.positions_of(mesh);
        std::array<std::uint32_t, 2> ends{};
        if (stroke_) ends = stroke_vertices(mesh.primitive(), instance.mesh.element_of(local_));
        for (std::size_t k = 0; k < (stroke_ ? 2 : 3); ++k) {
            const std::size_t vertex = stroke_ ? ends[k] : instance.mesh.triangles[3 * std::size_t{local_} + k];
            here_[k] = clip_position(now_.node_to_clip[node], mesh.view.positions + 3 * vertex);
            there_[k] = clip_position(other_.frame.node_to_clip[node], positions + 3 * vertex);
        }
    }

    const Frame& now_;
    const OtherShot& other_;
    const Moved& moved_;
    const MaterialView* materials_;
    OtherTriangles triangles_;
    std::uint32_t triangle_ = 0xffffffffu, local_ = 0, there_instance_ = kNoInstance, primitive_ = 0, node_ = 0;
    const InstanceView* shape_ = nullptr;  // drawn by its formula
    bool stands_ = false, stroke_ = false;
    glm::dvec4 here_[3], there_[3];
    glm::dvec4 eye_there_;  // in the space of a shape
};

}  // namespace

void OtherShot::keep_positions() {
    positions_.clear();
    for (std::size_t i = 0; i < frame.instances.size(); ++i) {
        const PreparedMesh& mesh = prepared_mesh(*frame.prepared[i]);
        if (!mesh.deformed) continue;
        std::vector<float>& copy = positions_[&mesh];
        if (copy.empty())
            copy.assign(mesh.view.positions, mesh.view.positions + 3 * std::size_t{mesh.view.vertex_count});
        if (!frame.instances[i].mesh.is_stroke()) frame.instances[i].mesh.positions = copy.data();
    }
}

const float* OtherShot::positions_of(const PreparedMesh& mesh) const {
    const auto found = positions_.find(&mesh);
    return found == positions_.end() ? mesh.view.positions : found->second.data();
}

void measure_motion(const Frame& now, const std::uint32_t* triangles, const MaterialView* materials,
                    const OtherShot* after, const OtherShot* before, Arena& arena, const MotionPlanes& planes) {
    const auto width = static_cast<std::size_t>(now.projection.width),
               height = static_cast<std::size_t>(now.projection.height);
    std::fill_n(planes.vectors, 4 * width * height, 0.0f);
    std::fill_n(planes.seen, width * height, 0u);
    const OtherShot* const shots[2] = {after, before};
    for (std::size_t s = 0; s < 2; ++s) {
        std::optional<Moved> moved;
        if (shots[s]) moved.emplace(now, *shots[s]);
        constexpr std::size_t kRows = 8;
        arena.for_each((height + kRows - 1) / kRows, [&](std::size_t part) {
            std::optional<RowMotion> motion;
            if (shots[s]) motion.emplace(now, *shots[s], *moved, materials);
            const std::size_t end = std::min((part + 1) * kRows, height);
            for (std::size_t y = part * kRows; y < end; ++y)
                for (std::size_t x = 0; x < width; ++x) {
                    const std::size_t i = y * width + x;
                    if (triangles[i] == 0) continue;
                    const bool seen = !motion || motion->measure(triangles[i] - 1, static_cast<int>(x),
                                                                 static_cast<int>(y), planes.vectors + 4 * i + 2 * s);
                    planes.seen[i] |= seen ? 1u << s : 0u;
                }
        });
    }
}

}  // namespace tessera
