#include "raster/kernel_world.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace tessera::test {
namespace {

constexpr float kNear = 0.125f;
constexpr float kLens[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, kNear, 0, 0, -1, 0};

}  // namespace

KernelMesh::KernelMesh(Random& random, Place place, std::uint32_t triangles)
    : positions_(9 * std::size_t{triangles}),
      normals_(9 * std::size_t{triangles}),
      tangents_(12 * std::size_t{triangles}),
      colors_(12 * std::size_t{triangles}),
      uvs_{GuardedArray<float>(6 * std::size_t{triangles}), GuardedArray<float>(6 * std::size_t{triangles})},
      indices_(3 * std::size_t{triangles}) {
    const std::uint32_t vertices = 3 * triangles;
    // Every vertex once, in an order that is nearly that of memory; some again in place of others.
    for (std::uint32_t i = 0; i < vertices; ++i) indices_[i] = i;
    for (std::uint32_t t = 0; t < triangles; ++t) {
        place_triangle(random, place, t);
        if (random.below(2)) std::swap(indices_[3 * t], indices_[3 * t + 1]);
        if (t > 0 && place != Place::kLayers && random.below(8) == 0) indices_[3 * t] = random.below(3 * t);
        if (t > 0 && place == Place::kLayers && t % 2) std::copy_n(&indices_[3 * (t - 1)], 3, &indices_[3 * t]);
    }
    for (std::uint32_t i = 0; i < vertices; ++i) {
        const Vec3T<float> n = random.below(50) ? random.unit() : Vec3T<float>{0, 0, 0}, t = random.unit();
        const float numbers[] = {n.x, n.y, n.z, t.x, t.y, t.z, random.below(2) ? 1.0f : -1.0f};
        std::copy_n(numbers, 3, &normals_[3 * i]);
        std::copy_n(numbers + 3, 4, &tangents_[4 * i]);
        for (std::uint32_t c = 0; c < 4; ++c) colors_[4 * i + c] = random.in(0, 1);
        for (auto& uv : uvs_) uv[2 * i] = random.in(-2, 3), uv[2 * i + 1] = random.in(-2, 3);
    }
    instance_.mesh = {positions_.data(), normals_.data(), tangents_.data(), {uvs_[0].data(), uvs_[1].data()},
                      colors_.data(),    indices_.data(), triangles,        vertices};
    std::memcpy(instance_.object_to_clip, kLens, sizeof kLens);
    const float camera[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, normal[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::memcpy(instance_.object_to_camera, camera, sizeof camera);
    std::memcpy(instance_.normal_to_camera, normal, sizeof normal);
    instance_.handedness = random.below(4) ? 1.0f : -1.0f;
}

void KernelMesh::put(std::uint32_t vertex, float pixel_x, float pixel_y, float distance) {
    float* p = &positions_[3 * std::size_t{vertex}];
    p[0] = (pixel_x * (2.0f / kWidth) - 1) * distance;
    p[1] = (1 - pixel_y * (2.0f / kHeight)) * distance;
    p[2] = -distance;
}

void KernelMesh::spoil(Random& random, std::uint32_t vertex) {
    constexpr float kOdd[] = {std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity(),
                              1e20f,
                              -1e15f,
                              1e-40f,
                              0.0f,
                              -0.0f,
                              3e38f};
    float* p = &positions_[3 * std::size_t{vertex}];
    if (random.below(4) == 0) {
        std::fill_n(p, 3, kOdd[random.below(std::size(kOdd))]);
    } else {
        p[random.below(3)] = kOdd[random.below(std::size(kOdd))];
    }
}

void KernelMesh::place_triangle(Random& random, Place place, std::uint32_t triangle) {
    if (place == Place::kMixed) place = kPlaces[random.below(std::size(kPlaces) - 1)];
    const auto grid = [&](float low, float high) { return std::floor(random.in(low, high) * 256) / 256; };
    const float middle_x = grid(-4, kWidth + 4), middle_y = grid(-4, kHeight + 4);
    const float distance = std::exp2(std::floor(random.in(-2, 6)));
    float size = 4;
    switch (place) {
        case Place::kSubPixel:
            size = 0.7f;
            break;
        case Place::kMedium:
            size = 36;
            break;
        case Place::kHuge:
            size = 200;
            break;
        default:
            break;
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = 3 * triangle + k;
        float x = middle_x + grid(-size, size), y = middle_y + grid(-size, size);
        float d = random.below(2) ? distance : distance * 2;
        const auto beside = [&](float at) { return at + static_cast<float>(random.below(5)) / 256 - 2.0f / 256; };
        switch (place) {
            case Place::kDegenerate:
                if (k == 1 || (k == 2 && random.below(2))) x = middle_x, y = middle_y;
                if (k == 2) x = middle_x + 3, y = middle_y;
                break;
            case Place::kSampleCentres: {
                const auto centre = [&](float at) {
                    const std::uint32_t reach = triangle % 3 ? 7 : 60;
                    return std::floor(at) + 0.5f + static_cast<float>(random.below(reach)) - 3;
                };
                x = centre(middle_x);
                y = centre(middle_y);
                break;
            }
            case Place::kTileBorders:
                x = beside(static_cast<float>(32 * random.below(9)));
                y = beside(static_cast<float>(32 * random.below(5)));
                if (random.below(2)) x = beside(std::floor(middle_x / 32) * 32 + static_cast<float>(k));
                if (random.below(2)) y = beside(std::floor(middle_y / 32) * 32 + static_cast<float>(k % 2));
                break;
            case Place::kPictureBorders:
                x = beside(random.below(2) ? (random.below(2) ? 0.0f : static_cast<float>(kWidth)) : middle_x);
                y = beside(random.below(2) ? (random.below(2) ? 0.0f : static_cast<float>(kHeight)) : y);
                break;
            case Place::kGuardBand:  // 3.5 half pictures from the centre
                x = 0.5f * kWidth * (1 + 3.5f * (random.below(2) ? 1.0f : -1.0f)) +
                    grid(0, 1.02f) * (random.below(3) ? 0.0f : 1.0f);
                if (random.below(2)) x = middle_x;
                y = 0.5f * kHeight * (1 + 3.5f * (random.below(2) ? 1.0f : -1.0f));
                if (random.below(2)) y = middle_y;
                break;
            case Place::kBehindEye:
                if (k == triangle % 3) d = -d;
                if (random.below(4) == 0) d = kNear;
                break;
            case Place::kLayers:
                d = distance;
                x = middle_x + grid(-20, 20);
                y = middle_y + grid(-20, 20);
                break;
            default:
                break;
        }
        put(v, x, y, d);
        if (place == Place::kUnusable && random.below(2)) spoil(random, v);
    }
}

KernelWorld::KernelWorld(Random& random) {
    constexpr int kSizes[kTextureSlots][3] = {{64, 32, 7}, {1, 1, 1},   {37, 5, 6}, {16, 16, 5},
                                              {128, 1, 8}, {32, 64, 7}, {9, 9, 4},  {16, 8, 5}};
    for (std::size_t i = 0; i < kTextureSlots; ++i)
        textures_.push_back(
            std::make_unique<TestTexture>(kSizes[i][0], kSizes[i][1], kSizes[i][2], static_cast<std::uint32_t>(i + 1)));
    constexpr ShadingModel kModels[] = {ShadingModel::kBlinnPhong, ShadingModel::kMetallicRoughness,
                                        ShadingModel::kUnlit, ShadingModel::kPhong};
    for (std::uint32_t i = 0; i < kMaterials; ++i) {
        MaterialView m = plain_material(kModels[i % 4]);
        m.alpha_mode = static_cast<AlphaMode>(i / 4);
        m.double_sided = i % 3 != 0;
        m.alpha_cutoff = 0.5f;
        m.metallic = random.in(0, 1);
        m.roughness = random.in(0.1f, 1);
        for (float& c : m.base_color) c = random.in(0.3f, 1);
        set3(m.specular, {0.4f, 0.4f, 0.4f});
        set3(m.ambient, {0.1f, 0.1f, 0.1f});
        // By turns without textures, with one, with all of them.
        for (std::uint32_t slot = 0; slot < (i % 3 == 0 ? 0 : i % 3 == 1 ? 1u : kTextureSlots); ++slot) {
            m.inputs[slot].texture = &textures_[slot]->view();
            m.inputs[slot].uv_set = static_cast<std::int32_t>(slot % 2);
            const float transform[6] = {0.9f, 0.2f, 0.1f, -0.3f, 1.1f, 0.4f};
            std::memcpy(m.inputs[slot].transform, transform, sizeof transform);
        }
        materials_.push_back(m);
    }
    lights_.push_back(directional_light({0.6f, 0.8f, 0.0f}, 3));
    lights_.push_back(point_light({1, 2, -1}, 20));
    lights_.back().falloff = LightFalloff::kConstant;
    context = plain_context(lights_);
    context.materials = materials_.data();
    context.ambient = {{0.5f, 0.6f, 0.7f}, {0.1f, 0.2f, 0.1f}, {0, 1, 0}};
    projection.width = KernelMesh::kWidth;
    projection.height = KernelMesh::kHeight;
    std::memcpy(projection.clip_from_camera, kLens, sizeof kLens);
    projection.scale_x = projection.scale_y = 1;
    projection.near = kNear;
}

void KernelWorld::add(const KernelMesh& mesh, std::uint32_t material, bool scattered) {
    const std::uint32_t before =
        instances_.empty() ? 0 : instances_.back().first_triangle + instances_.back().mesh.triangle_count;
    instances_.push_back(mesh.instance());
    instances_.back().material = material;
    instances_.back().first_triangle = before;
    // By one lane, so that the kernels that read them are compared alone; they end where memory ends.
    const MeshView& m = mesh.instance().mesh;
    const std::uint32_t count = scattered ? 3 * m.triangle_count : m.vertex_count;
    std::vector<TransformedVertex> padded(count + kMaxLanes);
    raster_kernels(Isa::kScalar)
        .transform({&mesh.instance(), projection.width, projection.height, scattered ? m.triangles : nullptr, 0, count,
                    padded.data()});
    padded.resize(count);
    transformed_.push_back(std::make_unique<GuardedArray<TransformedVertex>>(padded));
    for (std::size_t i = numbers_.size(); i < 3 * KernelMesh::kMostTriangles; ++i)
        numbers_.push_back(static_cast<std::uint32_t>(i));
    vertices_.push_back({transformed_.back()->data(), scattered ? numbers_.data() : m.triangles});
}

SurfaceSource KernelWorld::source() const {
    return {instances_.data(), vertices_.data(), &context, projection, &make_one_record};
}

void make_one_record(const InstanceView& instance, std::uint32_t triangle, const ProjectionView& projection,
                     const SurfaceLayout& layout, float* record) {
    TriangleSetup setup;
    setup_triangle(instance, triangle, projection, setup);
    if (setup.visible()) make_surface_record(instance, triangle, setup, projection, layout, record);
}

bool covers(const SnappedVertex (&v)[3], std::int32_t x, std::int32_t y) {
    for (int k = 0; k < 3; ++k) {
        const SnappedVertex &a = v[k], &b = v[(k + 1) % 3];
        const std::int64_t dx = static_cast<std::int64_t>(b.x) - a.x, dy = static_cast<std::int64_t>(b.y) - a.y;
        const std::int64_t e = dx * (static_cast<std::int64_t>(y) - a.y) - dy * (static_cast<std::int64_t>(x) - a.x);
        const bool top_left = dy < 0 || (dy == 0 && dx > 0);
        if (e < 0 || (e == 0 && !top_left)) return false;
    }
    return true;
}

bool same_floats(const float* a, const float* b, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]) && (a[i] == a[i] || b[i] == b[i]))
            return false;
    return true;
}

}  // namespace tessera::test
