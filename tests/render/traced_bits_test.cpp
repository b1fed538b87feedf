// The ray tracer's pictures have the same bits whatever the threads, tiles, instruction sets and what was drawn
// before; and stop where they are told to.
#include <gtest/gtest.h>

#include "render/traced_pictures.h"

namespace tessera {
namespace {

using namespace test;

TEST(TracedBits, TheSameBitsWhateverTheThreadsAndTiles) {
    const Scene scene = many_kinds();
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        RenderOptions o = of_many_kinds(engine);
        o.samples = 2;
        o.threads = 1;
        const RenderResult first = render(scene, o);
        for (const int threads : {2, 4}) {
            o.threads = threads;
            const RenderResult r = render(scene, o);
            EXPECT_TRUE(same_bytes(first.linear, r.linear)) << name(engine) << ", " << threads << " threads";
            EXPECT_EQ(first.stats.shadow_rays, r.stats.shadow_rays);
            EXPECT_EQ(first.stats.mirrored_rays, r.stats.mirrored_rays);
            EXPECT_EQ(first.stats.refracted_rays, r.stats.refracted_rays);
            EXPECT_EQ(first.stats.straight_rays, r.stats.straight_rays);
        }
        o.threads = 2;
        for (const int side : {32, 64, 128}) {
            o.raster.tile_side = side;
            const RenderResult r = render(scene, o);
            EXPECT_TRUE(same_bytes(first.linear, r.linear)) << name(engine) << ", tiles of " << side;
            EXPECT_EQ(r.stats.tile_side, side);
        }
    }
}

TEST(TracedBits, TheSameBitsOfARendererThatDrawsAgain) {
    const Scene scene = many_kinds();
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        const RenderOptions o = of_many_kinds(engine);
        const RenderResult once = render(scene, o);
        Renderer renderer(scene, o);
        RenderResult again;
        View aside = o.view;
        aside.eye = Vec3{2, 1, 3};
        for (const View& view : {o.view, aside, o.view}) renderer.draw(view, again);
        EXPECT_TRUE(same_bytes(once.linear, again.linear)) << name(engine);
        EXPECT_EQ(once.stats.shadow_rays, again.stats.shadow_rays) << name(engine);
    }
}

// Kernels have the same bits; Embree's own tests round as its instruction set does.
TEST(TracedBits, NearlyTheSameBitsOnEveryInstructionSet) {
    const Scene scene = many_kinds();
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        RenderOptions o = of_many_kinds(engine);
        o.isa = Isa::kScalar;
        const RenderResult scalar = render(scene, o);
        for (const Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
            if (!isa_supported(isa)) continue;
            o.isa = isa;
            const Differences d = differences(scalar, render(scene, o));
            print(std::string(name(engine)) + ", " + name(isa) + " and scalar", d);
            EXPECT_LE(part(d.bits, scalar), 2e-3) << name(engine) << ", " << name(isa);
        }
    }
}

// Hierarchies that were refitted are those that are built at the moment.
TEST(TracedBits, TheSameBitsOfMovingScenesAtAnyMoment) {
    const Scene scene = scene_file("motion.gltf");
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        RenderOptions o = quick(engine, 96, 72);
        o.moment = {0, 0};
        Renderer renderer(scene, o);
        RenderResult moving;
        for (const double time : {0.0, 0.3, 0.6, 0.3}) {
            renderer.draw(o.view, {0, time}, moving);
            RenderOptions at = o;
            at.moment.time = time;
            const Differences d = differences(render(scene, at), moving);
            print(std::string(name(engine)) + " at a moment of a moving scene", d);
            EXPECT_LE(d.bits, 7u) << name(engine) << " " << time;
        }
    }
}

ErrorCode refusal(const Scene& scene, const RenderOptions& o) {
    try {
        render(scene, o);
    } catch (const Error& e) {
        return e.code();
    }
    ADD_FAILURE() << "accepted";
    return ErrorCode::kInternal;
}

TEST(TracedBits, TracingStopsAndStaysWithinTheMemory) {
    const Scene scene = many_kinds();
    for (const Engine engine : {Engine::kTrace, Engine::kHybrid}) {
        RenderOptions o = of_many_kinds(engine);
        double reached = 0;
        bool rising = true;
        o.progress = [&](double p) { rising = rising && p >= reached, reached = p; };
        render(scene, o);
        EXPECT_TRUE(rising);
        EXPECT_GT(reached, 0.9);
        reached = 0;
        o.cancel = [&] { return reached > 0.2; };
        EXPECT_EQ(refusal(scene, o), ErrorCode::kCancelled) << name(engine);
        EXPECT_LT(reached, 0.9);
    }
    Scene large;
    place(large, sphere(300, kNone), {});
    RenderOptions o = quick(Engine::kTrace, 32, 32);
    o.max_bytes = 4 << 20;  // of 360,000 triangles
    EXPECT_EQ(refusal(large, o), ErrorCode::kLimit);
}

}  // namespace
}  // namespace tessera
