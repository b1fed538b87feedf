// The kernel that shades points of a wave, of every instruction set against one lane: every model and alpha mode, with
// and without textures, light of one and of three channels, mirrors, glass and media.
#include "trace_kernels/wave_arrays.h"

namespace tessera {
namespace {

using namespace test;

class WaveShadeKernels : public TraceKernelTest {};

enum class Body { kPlain, kMirror, kPane, kGlass };
constexpr Body kBodies[] = {Body::kPlain, Body::kMirror, Body::kPane, Body::kGlass};

void make_body(MaterialView& m, Body body, Random& random) {
    if (body == Body::kPlain) return;
    for (float& c : m.mirror) c = random.in(0, 1);
    m.roughness = random.in(0, 0.3f);
    if (body == Body::kMirror) return;
    m.transmission = random.in(0.1f, 1);
    for (float& c : m.tint) c = random.in(0, 1);
    m.thin = body == Body::kPane;
    for (float& c : m.ior) c = random.in(1, 2);
}

TEST_P(WaveShadeKernels, SameShades) {
    Random random(1);
    KernelWorld world(random);
    const KernelMesh mesh(random, Place::kSmall, 2);
    TestTexture clear(32, 8, 6, 5);  // where light enters
    const auto lights = static_cast<std::size_t>(world.context.light_count);
    std::size_t shaded = 0;
    for (std::uint32_t number = 0; number < 2 * KernelWorld::kMaterials; ++number)
        for (const Body body : kBodies)
            for (const int channels : {1, 3}) {
                MaterialView material = world.material(number / 2);
                if (number >= KernelWorld::kMaterials && material.model == ShadingModel::kMetallicRoughness)
                    material.model = ShadingModel::kSpecularGlossiness;
                if (number % 4 == 1 && material.model == ShadingModel::kPhong) material.model = ShadingModel::kLambert;
                make_body(material, body, random);
                TextureInput& entering = material.inputs[static_cast<std::size_t>(TextureSlot::kTransmission)];
                if (entering.texture) entering.texture = &clear.view();
                ShadingContext context = world.context;
                context.bounces = random.below(4) != 0;
                MeshView attributes = mesh.instance().mesh;
                if (number % 2) attributes.colors = nullptr;
                if (number % 3 == 2) attributes.uvs[1] = nullptr;
                const SurfaceLayout layout = surface_layout(attributes, material, number % 5 == 4);
                for (const std::uint32_t count : {1u, 3u, 4u, 15u, 16u, 17u, 33u, 63u, 64u, 65u, 130u}) {
                    const std::uint32_t first = kMaxLanes * random.below(3);
                    const std::uint32_t all = first + (count + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
                    GuardedWave points(kPointNumbers, all), got(kShadeNumbers, all), want(kShadeNumbers, all);
                    fill_points(points, random, count % 2);
                    GuardedWave arrives(static_cast<int>(lights) * channels, all);
                    for (int n = 0; n < static_cast<int>(lights) * channels; ++n)
                        for (std::uint32_t i = 0; i < all; ++i)
                            arrives[n][i] = random.below(3) ? random.in(0, 1) : 0.0f;
                    TracedShadeJob job{&context,     &material,
                                       layout,       points.arrays(),
                                       got.arrays(), {arrives.arrays().base, arrives.arrays().stride, channels},
                                       first,        count};
                    traced().shade(job);
                    job.shades = want.arrays();
                    one_lane().shade(job);
                    ASSERT_TRUE(got.same(want, kShadeNumbers, first + count))
                        << "material " << number << ", body " << static_cast<int>(body) << ", " << count;
                    ASSERT_FALSE(got.changed() || points.changed());
                    shaded += count;
                }
            }
    EXPECT_GT(shaded, 50000u);
}

// Of light that comes from all sides alike no part of a dielectric's surface sends on more than arrives.
TEST_P(WaveShadeKernels, ShadesGainNothing) {
    Random random(2);
    const std::vector<LightView> none;
    ShadingContext context = plain_context(none);
    context.bounces = true;
    context.ambient = even_ambient(1);
    context.ambient.uniform = true;
    constexpr std::uint32_t kCount = 4 * kMaxLanes;
    for (int round = 0; round < 200; ++round) {
        MaterialView m = plain_material(ShadingModel::kMetallicRoughness);
        m.metallic = random.below(3) ? random.in(0, 1) : 0.0f;
        m.roughness = random.in(0, 0.5f);
        m.transmission = random.below(3) ? random.in(0, 1) : 1.0f;
        m.thin = random.below(2) == 0;
        for (float& c : m.ior) c = 1.5f;
        GuardedWave points(kPointNumbers, kCount), shades(kShadeNumbers, kCount);
        fill_points(points, random, false);
        for (std::uint32_t i = 0; i < kCount; ++i) {  // seen from above
            const Vec3T<float> n = random.unit(), view = normalize_or(n + random.unit() * 0.95f, n);
            points.set3(kNormalX, i, n), points.set3(kFlatX, i, n), points.set3(kViewX, i, view);
            points[kFacing][i] = m.thin || random.below(2) ? 1.0f : -1.0f;
            for (int c = 0; c < 3; ++c) points[kEtaR + c][i] = points[kFacing][i] < 0 ? 1.5f : 1 / 1.5f;
        }
        traced().shade({&context, &m, SurfaceLayout{}, points.arrays(), shades.arrays(), {nullptr, 0, 1}, 0, kCount});
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const float sum = shades[kRadianceG][i] + shades[kReflectedG][i] + shades[kEnteringG][i];
            EXPECT_LE(sum, 1.0001f) << "metallic " << m.metallic << ", roughness " << m.roughness << ", transmission "
                                    << m.transmission << (m.thin ? ", thin" : "") << ", facing " << points[kFacing][i];
            EXPECT_GE(shades[kReflectedG][i], 0);
            EXPECT_GE(shades[kEnteringG][i], 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Kernels, WaveShadeKernels, vector_isas(), isa_name);

}  // namespace
}  // namespace tessera
