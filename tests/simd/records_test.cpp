// Records in memory to lanes and back: every bit arrives where it belongs on every instruction set, 16
// bytes of each record are touched and none beside them.
#include "simd/record_kernels.h"

#include "simd/guarded_memory.h"
#include "simd/simd_inputs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace tessera {
namespace {

using test::GuardedArray;

class RecordsTest : public testing::TestWithParam<Isa> {
  protected:
    void SetUp() override {
        if (!isa_supported(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not supported here";
    }
    const RecordTable& table() const { return record_table(GetParam()); }
    std::uint32_t lanes() const { return static_cast<std::uint32_t>(table().lanes); }
    // Any bits: NaNs with their payload, denormals, infinities.
    std::uint32_t bits() {
        const std::vector<std::uint32_t>& special = special_bits();
        return random_() % 2 ? special[random_() % special.size()] : static_cast<std::uint32_t>(random_());
    }
    std::mt19937 random_{7};
};

// Each record ends where memory ends, at any alignment of a float, and several lanes may share one.
TEST_P(RecordsTest, LoadsEveryBitAndNothingBehindTheRecord) {
    for (int round = 0; round < 300; ++round) {
        std::vector<std::unique_ptr<GuardedArray<std::uint32_t>>> records;
        for (std::uint32_t i = 0; i < 3; ++i) {
            records.push_back(std::make_unique<GuardedArray<std::uint32_t>>(4));
            for (std::size_t k = 0; k < 4; ++k) (*records[i])[k] = bits();
        }
        const float* pointers[kMostLanes];
        std::uint32_t which[kMostLanes];
        for (std::uint32_t lane = 0; lane < lanes(); ++lane) {
            which[lane] = static_cast<std::uint32_t>(random_()) % 3;
            pointers[lane] = reinterpret_cast<const float*>(records[which[lane]]->data());
        }
        float planes[4 * kMostLanes];
        table().load_records(pointers, planes);
        for (std::uint32_t lane = 0; lane < lanes(); ++lane)
            for (std::size_t k = 0; k < 4; ++k)
                ASSERT_EQ(std::bit_cast<std::uint32_t>(planes[k * lanes() + lane]), (*records[which[lane]])[k])
                    << "number " << k << " of lane " << lane;
    }
}

TEST_P(RecordsTest, StoresEveryBitAndNothingBesideTheRecord) {
    for (int round = 0; round < 300; ++round) {
        // Slots in a random order; gaps of 0 to 2 floats between them.
        const std::size_t stride = 4 + random_() % 3;
        std::vector<std::uint32_t> memory(stride * lanes() + 7, 0xdeadbeef);
        std::vector<std::uint32_t> slot(lanes());
        for (std::uint32_t lane = 0; lane < lanes(); ++lane) slot[lane] = lane;
        std::shuffle(slot.begin(), slot.end(), random_);
        std::vector<std::uint32_t> want = memory;
        float* pointers[kMostLanes];
        float planes[4 * kMostLanes];
        for (std::uint32_t lane = 0; lane < lanes(); ++lane) {
            const std::size_t at = 3 + stride * slot[lane];
            pointers[lane] = reinterpret_cast<float*>(memory.data() + at);
            for (std::size_t k = 0; k < 4; ++k) {
                want[at + k] = bits();
                std::memcpy(&planes[k * lanes() + lane], &want[at + k], 4);
            }
        }
        table().store_records(pointers, planes);
        ASSERT_EQ(memory, want);
    }
    GuardedArray<float> last(4);
    float* pointers[kMostLanes];
    std::fill_n(pointers, kMostLanes, last.data());
    const float planes[4 * kMostLanes] = {};
    table().store_records(pointers, planes);
    EXPECT_FALSE(last.changed());
}

TEST_P(RecordsTest, LoadsTriplesUpToTheEndOfMemory) {
    GuardedArray<std::uint32_t> records(3 * lanes());
    for (int round = 0; round < 100; ++round) {
        for (std::size_t i = 0; i < records.size(); ++i) records[i] = bits();
        float planes[3 * kMostLanes];
        table().load_triples(reinterpret_cast<const float*>(records.data()), planes);
        for (std::uint32_t lane = 0; lane < lanes(); ++lane)
            for (std::size_t k = 0; k < 3; ++k)
                ASSERT_EQ(std::bit_cast<std::uint32_t>(planes[k * lanes() + lane]), records[3 * lane + k]);
    }
}

TEST_P(RecordsTest, LeastLaneIsTheLeastWhereverItIs) {
    float values[kMostLanes];
    for (int round = 0; round < 2000; ++round) {
        for (float& v : values) {
            do v = std::bit_cast<float>(bits());
            while (v != v);
        }
        const float want = *std::min_element(values, values + lanes());
        ASSERT_EQ(table().least_lane(values), want);
    }
    for (std::uint32_t i = 0; i < lanes(); ++i) {
        std::fill_n(values, kMostLanes, std::numeric_limits<float>::infinity());
        values[i] = 3.4e38f;
        EXPECT_EQ(table().least_lane(values), 3.4e38f) << i;
    }
}

TEST_P(RecordsTest, CompressMovesTheLanesOfAnyMaskToTheFront) {
    float values[kMostLanes], front[kMostLanes];
    for (std::size_t i = 0; i < kMostLanes; ++i) values[i] = static_cast<float>(i) + 0.5f;
    for (std::uint32_t bits = 0; bits < 1u << lanes(); ++bits) {
        ASSERT_EQ(table().compress(bits, values, front), bits);
        std::size_t next = 0;
        for (std::size_t lane = 0; lane < lanes(); ++lane)
            if (bits >> lane & 1) {
                ASSERT_EQ(front[next], values[lane]) << bits;
                ++next;
            }
    }
}

INSTANTIATE_TEST_SUITE_P(Simd, RecordsTest, testing::Values(Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512),
                         [](const auto& instance) { return std::string(name(instance.param)); });

}  // namespace
}  // namespace tessera
