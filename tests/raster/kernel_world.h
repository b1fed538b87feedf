// Random and adversarial input for the rasterizer's kernels: meshes whose arrays end where memory ends,
// placed at chosen positions of the picture; materials, textures and lights; and what a chunk's set-up
// leaves for a tile.
#pragma once

#include "core/fp_environment.h"
#include "raster/kernels.h"
#include "shading/support.h"
#include "simd/guarded_memory.h"
#include "tile/kernels.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace tessera::test {

// All kernels that draw tiles.
struct Kernels : RasterKernels, TileKernels {
    explicit Kernels(Isa isa) : RasterKernels(raster_kernels(isa)), TileKernels(tile_kernels(isa)) {}
};

// Kernels of one instruction set beside the one-lane ones.
class KernelTest : public testing::TestWithParam<Isa> {
  protected:
    void SetUp() override {
        if (!isa_supported(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not supported here";
    }
    Kernels kernels() const { return Kernels(GetParam()); }
    static Kernels scalar() { return Kernels(Isa::kScalar); }

  private:
    FpEnvironment exact_;
};
inline auto vector_isas() { return testing::Values(Isa::kSse4, Isa::kAvx2, Isa::kAvx512); }
inline std::string isa_name(const testing::TestParamInfo<Isa>& info) { return name(info.param); }

// Where triangles lie and what is wrong with them.
enum class Place {
    kSubPixel,       // about a pixel in size
    kSmall,          // up to 8 pixels
    kMedium,         // up to the sides where 32-bit areas end
    kHuge,           // up to the guard band
    kDegenerate,     // points and lines
    kSampleCentres,  // vertices and level edges on samples: ties of the fill rule
    kTileBorders,    // vertices on or beside multiples of 32 pixels
    kPictureBorders,
    kGuardBand,  // on its edge, and just beyond
    kBehindEye,  // crossing the near plane
    kUnusable,   // NaN, infinities, 1e20, denormals, all zero
    kLayers,     // level, each twice: equal depths
    kMixed,      // all of these
};
inline constexpr Place kPlaces[] = {
    Place::kSubPixel,      Place::kSmall,       Place::kMedium,         Place::kHuge,      Place::kDegenerate,
    Place::kSampleCentres, Place::kTileBorders, Place::kPictureBorders, Place::kGuardBand, Place::kBehindEye,
    Place::kUnusable,      Place::kLayers,      Place::kMixed};

// A mesh before a lens of 90 degrees that sees a picture of 256 x 128 pixels, so that pixel positions of
// 1/256 reach clip space exactly.
class KernelMesh {
  public:
    static constexpr int kWidth = 256, kHeight = 128;
    static constexpr std::uint32_t kMostTriangles = 400;

    KernelMesh(Random& random, Place place, std::uint32_t triangles);

    InstanceView& instance() { return instance_; }
    const InstanceView& instance() const { return instance_; }
    std::uint32_t triangles() const { return instance_.mesh.triangle_count; }

  private:
    void place_triangle(Random& random, Place place, std::uint32_t triangle);
    void spoil(Random& random, std::uint32_t vertex);
    void put(std::uint32_t vertex, float pixel_x, float pixel_y, float distance);

    GuardedArray<float> positions_, normals_, tangents_, colors_, uvs_[2];
    GuardedArray<std::uint32_t> indices_;
    InstanceView instance_{};
};

// Materials by number: kMaterials of them, of every model and alpha mode, with and without textures.
class KernelWorld {
  public:
    static constexpr std::uint32_t kMaterials = 12;

    explicit KernelWorld(Random& random);
    KernelWorld(const KernelWorld&) = delete;
    KernelWorld& operator=(const KernelWorld&) = delete;

    // Adds an instance; its mesh must outlive the world. `scattered`: its vertices transformed per corner.
    void add(const KernelMesh& mesh, std::uint32_t material, bool scattered = false);
    SurfaceSource source() const;
    const std::vector<InstanceView>& instances() const { return instances_; }
    const MaterialView& material(std::uint32_t i) const { return materials_[i]; }
    ProjectionView projection{};
    ShadingContext context{};

  private:
    std::vector<std::unique_ptr<TestTexture>> textures_;
    std::vector<MaterialView> materials_;
    std::vector<LightView> lights_;
    std::vector<InstanceView> instances_;
    std::vector<std::unique_ptr<GuardedArray<TransformedVertex>>> transformed_;
    std::vector<InstanceVertices> vertices_;
    std::vector<std::uint32_t> numbers_;
};

// What the scalar path makes of a triangle, as the engine hands it to the kernels.
void make_one_record(const InstanceView& instance, std::uint32_t triangle, const ProjectionView& projection,
                     const SurfaceLayout& layout, float* record);

// The set-up of instances by one instruction set's kernels: triangles and runs of every tile, as one chunk.
struct SetupResult {
    std::vector<SmallTriangle> small;
    std::vector<LargeTriangle> large;
    std::vector<BinRun> runs;
    std::vector<std::uint32_t> run_tiles;
    FrontCounters counters;
    std::vector<std::uint32_t> calls;  // what was asked of the owner, in order
};
struct SetupOptions {
    SamplePosition sample{128, 128};
    bool one_sample = true, masks = true, double_sided = true;
    int tile_side = 32;
    std::uint32_t room = 64;  // for triangles, at first
};
void set_up(const RasterKernels& kernels, const KernelMesh& mesh, std::uint32_t instance, const SetupOptions& options,
            SetupResult& result);

// Whether a sample lies in a triangle of clockwise vertices: the edges in 64 bits, the rule spelled out.
bool covers(const SnappedVertex (&v)[3], std::int32_t x, std::int32_t y);

// Equal bits, but any NaN equals any other.
bool same_floats(const float* a, const float* b, std::size_t count);

}  // namespace tessera::test
