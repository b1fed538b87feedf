// Arenas: every index once, exceptions reach the caller, the exact floating-point environment.
#include "core/parallel.h"

#include "core/fp_environment.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace tessera {
namespace {

TEST(Arena, EveryIndexIsVisitedOnce) {
    for (const int threads : {0, 1, 2, 3, 8}) {
        Arena arena(threads);
        EXPECT_GE(arena.threads(), 1);
        for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
            std::vector<std::atomic<int>> visits(count);
            arena.for_each(count, [&](std::size_t i) { ++visits[i]; });
            for (const auto& v : visits) EXPECT_EQ(v, 1);
        }
    }
}

TEST(Arena, AnExceptionReachesTheCallerAndTheArenaGoesOn) {
    Arena arena(2);
    EXPECT_THROW(arena.for_each(100,
                                [](std::size_t i) {
                                    if (i == 37) throw std::runtime_error("37");
                                }),
                 std::runtime_error);
    std::atomic<int> count{0};
    arena.for_each(10, [&](std::size_t) { ++count; });
    EXPECT_EQ(count, 10);
}

TEST(Arena, LoopsNest) {
    Arena outer(2), inner(2);
    std::atomic<int> count{0};
    outer.for_each(4, [&](std::size_t) { inner.for_each(5, [&](std::size_t) { ++count; }); });
    EXPECT_EQ(count, 20);
}

#if defined(__x86_64__)
TEST(Arena, BEY1_TasksRunInTheExactEnvironment) {
    const unsigned saved = _mm_getcsr();
    _mm_setcsr(saved | 0x8040u);
    Arena arena(2);
    std::atomic<int> wrong{0};
    arena.for_each(64, [&](std::size_t) { wrong += (_mm_getcsr() & 0xe040u) != 0; });
    EXPECT_EQ(_mm_getcsr() & 0x8040u, 0x8040u) << "the caller's own modes are restored";
    _mm_setcsr(saved);
    EXPECT_EQ(wrong, 0);
}
#endif

TEST(Threads, AtLeastOneIsAvailable) { EXPECT_GE(available_threads(), 1); }

}  // namespace
}  // namespace tessera
