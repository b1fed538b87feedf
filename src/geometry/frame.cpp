#include "geometry/frame.h"

#include <tessera/error.h>

#include "geometry/matrix.h"
#include "scene/shapes.h"
#include "simd/math.h"

#include <algorithm>
#include <atomic>

namespace tessera {
namespace {

void store_rows(const glm::dmat4& m, int rows, float* out) {
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < 4; ++c) out[4 * r + c] = static_cast<float>(m[c][r]);
}

// Sets the vertical angle of the largest picture around the axis that these intrinsics hold, for views that frame what
// is visible; returns its aspect.
double framing_lens(const Intrinsics& k, int width, int height, View& view) {
    constexpr double kLeast = 1e-3, kMost = 1e7;  // pixels
    if (!(k.fx >= kLeast && k.fx <= kMost && k.fy >= kLeast && k.fy <= kMost))
        throw Error(ErrorCode::kUsage, "focal lengths of intrinsics must be 0.001 to 10000000 pixels");
    if (!(k.cx >= -kMost && k.cx <= kMost && k.cy >= -kMost && k.cy <= kMost))
        throw Error(ErrorCode::kUsage, "the centre of intrinsics must be finite, and within 10000000 pixels");
    double tx = std::min(k.cx + 0.5, width - k.cx - 0.5) / k.fx, ty = std::min(k.cy + 0.5, height - k.cy - 0.5) / k.fy;
    // An axis that leaves the picture frames nothing well; any angle will do.
    if (!(tx > 0)) tx = width / k.fx;
    if (!(ty > 0)) ty = height / k.fy;
    view.yfov = static_cast<float>(std::clamp(2 * math::atan2(ty, 1.0), 1e-3, 3.1));
    return tx / ty;
}

FrameCamera camera_of(PreparedScene& scene, const View& view, int width, int height) {
    if (view.clip_from_world.has_value() != view.camera_from_world.has_value())
        throw Error(ErrorCode::kUsage, "a view needs both of clip_from_world and camera_from_world, or neither");
    if (view.clip_from_world) return host_camera(*view.clip_from_world, *view.camera_from_world, width, height);
    if (!view.intrinsics) return frame_camera(scene.camera(view, static_cast<double>(width) / height), width, height);
    View posed = view;
    const double aspect = framing_lens(*view.intrinsics, width, height, posed);
    return frame_camera(scene.camera(posed, aspect), width, height);
}

// What all meshes at one node share.
InstanceView instance_at(const PreparedNode& node, const glm::dmat4& node_to_camera, const glm::dmat4& node_to_clip) {
    InstanceView instance{};
    store_rows(node_to_clip, 4, instance.object_to_clip);
    store_rows(node_to_camera, 3, instance.object_to_camera);
    const glm::dmat3 normals = normal_matrix(node_to_camera);
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) instance.normal_to_camera[3 * r + c] = static_cast<float>(normals[c][r]);
    instance.handedness = (determinant_sign(node_to_camera) < 0) != node.mirrored ? -1.0f : 1.0f;
    instance.skin_side = node.mirrored ? -1.0f : 1.0f;
    instance.node = static_cast<std::uint32_t>(node.node);
    return instance;
}

// Of a sphere or disc: its formula, unless rays would lose their precision in its space.
void draw_exactly(const Shape& shape, InstanceView& instance) {
    if (shape.type == Shape::Type::kPlane) return;  // its triangles are as exact
    if (!invert_rows(instance.object_to_camera, instance.shape.camera_to_object)) return;
    const bool sphere = shape.type == Shape::Type::kSphere;
    instance.shape.kind = sphere ? ShapeView::Kind::kSphere : ShapeView::Kind::kDisc;
    instance.shape.radius = shape.radius;
    instance.mesh.triangle_count = sphere ? 2 : 1;
}

constexpr std::uint64_t kMostTriangles = 0xfffffffeu;

[[noreturn]] void refuse_triangles() { throw Error(ErrorCode::kLimit, "the scene has more than 4294967294 triangles"); }

// Consecutive points or segments of one primitive: an instance of their own.
struct StrokeTask {
    const PreparedMesh* mesh;
    std::uint32_t first, count;
    std::size_t instance;
};
constexpr std::uint32_t kTaskElements = 16384;

// Returns how many.
std::size_t add_tasks(const PreparedMesh& mesh, std::uint32_t elements, std::size_t instance,
                      std::vector<StrokeTask>& tasks) {
    const std::size_t before = tasks.size();
    for (std::uint32_t first = 0, part = 0; first < elements; first += part) {
        part = std::min(kTaskElements, elements - first);
        tasks.push_back({&mesh, first, part, instance++});
    }
    return tasks.size() - before;
}

// Triangles for points and lines in place of them.
void make_strokes(const StrokeSpace& space, const std::vector<StrokeTask>& tasks, std::uint64_t max_bytes, Arena* arena,
                  Frame& frame) {
    while (frame.strokes.size() < tasks.size()) frame.strokes.push_back(std::make_unique<StrokeMesh>());
    std::atomic<std::uint64_t> bytes{0};
    const auto make = [&](std::size_t t) {
        const StrokeTask& task = tasks[t];
        StrokeMesh& mesh = *frame.strokes[t];
        InstanceView& instance = frame.instances[task.instance];
        mesh.make(instance, *task.mesh, task.first, task.count, space);
        if ((bytes += mesh.bytes()) > max_bytes)
            throw Error(ErrorCode::kLimit, "points and lines need more memory than the limit allows");
        instance.mesh = mesh.view;
        std::copy_n(space.to_clip, 16, instance.object_to_clip);
        std::copy_n(space.to_camera, 12, instance.object_to_camera);
        instance.handedness = instance.skin_side = 1;  // they are made so that their fronts are seen
        frame.prepared[task.instance] = &mesh;
    };
    if (arena) return arena->for_each(tasks.size(), make);
    for (std::size_t t = 0; t < tasks.size(); ++t) make(t);
}

// Numbers the triangles in the order of submission; instances without any go.
void number_triangles(Frame& frame) {
    std::uint64_t triangles = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < frame.instances.size(); ++i) {
        const InstanceView& instance = frame.instances[i];
        if (instance.mesh.triangle_count == 0) continue;
        frame.instances[kept] = instance;
        frame.instances[kept].first_triangle = static_cast<std::uint32_t>(triangles);
        if (frame.keep_nodes) frame.node_of_instance[kept] = frame.node_of_instance[i];
        frame.prepared[kept++] = frame.prepared[i];
        triangles += instance.mesh.triangle_count;
        if (triangles > kMostTriangles) refuse_triangles();
    }
    frame.instances.resize(kept);
    frame.prepared.resize(kept);
    if (frame.keep_nodes) frame.node_of_instance.resize(kept);
    frame.triangle_count = static_cast<std::uint32_t>(triangles);
}

}  // namespace

const InstanceView& Frame::instance_of(std::uint32_t number) const {
    const auto after = std::upper_bound(instances.begin(), instances.end(), number,
                                        [](std::uint32_t n, const InstanceView& i) { return n < i.first_triangle; });
    return *(after - 1);
}

void make_frame(PreparedScene& scene, const View& view, int width, int height, const StrokeStyle& style, Frame& frame) {
    const FrameCamera camera = camera_of(scene, view, width, height);
    frame.projection = camera.projection;
    frame.instances.clear();
    frame.prepared.clear();
    frame.lights.clear();
    frame.warnings.clear();
    frame.node_of_instance.clear();
    frame.node_to_clip.clear();
    frame.world_to_camera = camera.world_to_camera;
    frame.points = frame.lines = 0;
    frame.has_exact_shapes = false;
    const std::size_t lit = lit_materials(scene.scene());
    std::vector<StrokeTask> tasks;
    for (std::size_t n = 0; n < scene.nodes().size(); ++n) {
        const PreparedNode& node = scene.nodes()[n];
        const glm::dmat4 node_to_camera = camera.world_to_camera * node.world;
        if (node.light != kNone) frame.lights.push_back({node.light, node_to_camera});
        if (!node.has_mesh) continue;
        const glm::dmat4 node_to_clip = camera.node_to_clip(node.world, node_to_camera);
        if (frame.keep_nodes) {
            frame.node_to_clip.resize(scene.nodes().size(), glm::dmat4(0.0));
            frame.node_to_clip[n] = node_to_clip;
        }
        // Nothing can be said of where such a mesh is.
        if (!is_finite(node_to_clip) || !is_finite(to_dmat4(to_mat4(node_to_clip)))) {
            frame.warnings.push_back("node " + std::to_string(node.node) + ": its placement overflows; not drawn");
            continue;
        }
        InstanceView instance = instance_at(node, node_to_camera, node_to_clip);
        for (std::uint32_t i = node.first; i < node.placement_end; ++i) {
            const Placement& placement = scene.placements()[i];
            instance.mesh = placement.mesh->view;
            instance.first_primitive = placement.first_primitive;
            instance.material = placement.material;
            instance.scene_material = static_cast<std::uint32_t>(
                placement.material == ink_material(scene.scene()) ? lit - 1 : placement.material % lit);
            const Primitive& primitive = placement.mesh->primitive();
            instance.shape = {};
            if (frame.exact_shapes && primitive.shape) draw_exactly(*primitive.shape, instance);
            frame.has_exact_shapes = frame.has_exact_shapes || instance.shape;
            const std::uint64_t elements = element_count(primitive);
            std::size_t copies = 1;  // of strokes one for each task, which are filled below
            if (!has_triangles(primitive.mode)) {
                (primitive.mode == PrimitiveMode::kPoints ? frame.points : frame.lines) += elements;
                copies =
                    add_tasks(*placement.mesh, static_cast<std::uint32_t>(elements), frame.instances.size(), tasks);
            }
            frame.instances.insert(frame.instances.end(), copies, instance);
            frame.prepared.insert(frame.prepared.end(), copies, placement.mesh);
            if (frame.keep_nodes)
                frame.node_of_instance.insert(frame.node_of_instance.end(), copies, static_cast<std::uint32_t>(n));
        }
    }
    if (!tasks.empty()) make_strokes(StrokeSpace(camera, style), tasks, style.max_bytes, scene.arena(), frame);
    number_triangles(frame);
}

Frame make_frame(const Scene& scene, const View& view, int width, int height, const StrokeStyle& style) {
    Frame frame;
    frame.owned = std::make_shared<PreparedScene>(scene);
    make_frame(*frame.owned, view, width, height, style, frame);
    return frame;
}

float largest_coordinate(const InstanceView& instance, const DrawnMesh& mesh) {
    Bounds3 box = mesh.bounds;
    // Of a plane without end no facet is much larger than its distance from the middle.
    const std::optional<Shape>& shape = prepared_mesh(mesh).primitive().shape;
    if (shape && is_endless(*shape)) {
        box = {};
        box.add(Vec3{-1, 0, -1});
        box.add(Vec3{1, 0, 1});
    }
    const float most[3] = {std::max(std::abs(box.min.x), std::abs(box.max.x)),
                           std::max(std::abs(box.min.y), std::abs(box.max.y)),
                           std::max(std::abs(box.min.z), std::abs(box.max.z))};
    float largest = 0;
    for (int r = 0; r < 3; ++r) {
        const float* m = instance.object_to_camera + 4 * r;
        largest = std::max(
            largest, std::abs(m[0]) * most[0] + std::abs(m[1]) * most[1] + std::abs(m[2]) * most[2] + std::abs(m[3]));
    }
    return largest;
}

bool outside_view(const InstanceView& instance, const Bounds3& box) {
    if (box.empty()) return true;
    // Bit i stays set while every corner is outside plane i. The tolerance covers the rounding of the
    // vertices' own transformation in float, with room to spare.
    unsigned all = 63;
    for (int corner = 0; corner < 8; ++corner) {
        const double p[3] = {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                             corner & 4 ? box.max.z : box.min.z};
        double c[4], size = 0;
        for (int r = 0; r < 4; ++r) {
            const float* m = instance.object_to_clip + 4 * r;
            c[r] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
            size = std::max(size, std::abs(m[0] * p[0]) + std::abs(m[1] * p[1]) + std::abs(m[2] * p[2]) +
                                      std::abs(static_cast<double>(m[3])));
        }
        const double eps = 1e-5 * size;
        all &= (c[0] < -c[3] - eps ? 1u : 0u) | (c[0] > c[3] + eps ? 2u : 0u) | (c[1] < -c[3] - eps ? 4u : 0u) |
               (c[1] > c[3] + eps ? 8u : 0u) | (c[2] > c[3] + eps ? 16u : 0u) | (c[2] < -eps ? 32u : 0u);
    }
    return all != 0;
}

}  // namespace tessera
