// Every operation of the number layer on every instruction set of this processor gives the bits of the
// one-lane back end, lane by lane, on special and random values; nothing is written beside the output.
#include "simd/operations.h"

#include "simd/simd_inputs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace tessera {
namespace {

constexpr Isa kVectorIsas[] = {Isa::kSse4, Isa::kAvx2, Isa::kAvx512};
constexpr std::uint32_t kGuard = 0xdeadbeef;

bool is_nan(std::uint32_t bits) { return (bits & 0x7fffffff) > 0x7f800000; }

// Runs into a buffer with guards before and behind, at an odd place.
std::vector<std::uint32_t> run(const Operation& operation, const Inputs& in, std::size_t first, int count) {
    constexpr std::size_t kMargin = 33;
    const auto n = static_cast<std::size_t>(count);
    std::vector<std::uint32_t> buffer(n + 2 * kMargin, kGuard);
    operation.run(in.a.data() + first, in.b.data() + first, in.c.data() + first, buffer.data() + kMargin, count);
    for (std::size_t i = 0; i < kMargin; ++i) {
        EXPECT_EQ(buffer[i], kGuard) << operation.name << ": wrote before the output";
        EXPECT_EQ(buffer[kMargin + n + i], kGuard) << operation.name << ": wrote behind the output, count " << count;
    }
    return {buffer.begin() + kMargin, buffer.begin() + kMargin + count};
}

class OperationsTest : public testing::TestWithParam<Isa> {
  protected:
    void SetUp() override {
        if (!isa_supported(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not supported here";
    }
    const OperationTable& table() const { return operation_table(GetParam()); }
    const OperationTable& scalar() const { return operation_table(Isa::kScalar); }

    void expect_same(const Operation& operation, const Operation& expected, const Inputs& in, std::size_t first,
                     int count) const {
        const std::vector<std::uint32_t> got = run(operation, in, first, count);
        const std::vector<std::uint32_t> want = run(expected, in, first, count);
        for (std::size_t i = 0; i < got.size(); ++i) {
            if (got[i] == want[i] || (operation.float_result && is_nan(got[i]) && is_nan(want[i]))) continue;
            ADD_FAILURE() << operation.name << std::hex << "(0x" << in.a[first + i] << ", 0x" << in.b[first + i]
                          << ", 0x" << in.c[first + i] << ") = 0x" << got[i] << " on " << name(GetParam()) << " but 0x"
                          << want[i] << " on one lane; element " << std::dec << i << " of " << count;
            return;
        }
    }
};

TEST_P(OperationsTest, TableHasTheIsasWidthAndEveryOperation) {
    EXPECT_EQ(table().lanes, GetParam() == Isa::kSse4 ? 4 : GetParam() == Isa::kAvx2 ? 8 : 16);
    ASSERT_EQ(table().operations.size(), scalar().operations.size());
    EXPECT_EQ(scalar().lanes, 1);
}

TEST_P(OperationsTest, SpecialAndRandomValuesHaveTheBitsOfOneLane) {
    const Inputs in = make_inputs(20000);
    for (std::size_t i = 0; i < table().operations.size(); ++i) {
        ASSERT_STREQ(table().operations[i].name, scalar().operations[i].name);
        expect_same(table().operations[i], scalar().operations[i], in, 0, static_cast<int>(in.a.size()));
    }
}

TEST_P(OperationsTest, EveryCountAndAlignment) {
    const Inputs in = make_inputs(200);
    for (std::size_t i = 0; i < table().operations.size(); ++i)
        for (int count = 0; count <= 2 * table().lanes + 1; ++count)
            for (std::size_t first = 0; first < 3; ++first)
                expect_same(table().operations[i], scalar().operations[i], in, 500 + first, count);
}

INSTANTIATE_TEST_SUITE_P(Simd, OperationsTest, testing::ValuesIn(kVectorIsas),
                         [](const auto& instance) { return std::string(name(instance.param)); });

// The results themselves, recorded once: equal for g++ and clang builds and whatever glibc does.
TEST(OperationsHash, ResultsAreTheRecordedOnes) {
    const Inputs in = make_inputs(20000);
    for (const Isa isa : {Isa::kScalar, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
        if (!isa_supported(isa)) continue;
        std::uint64_t hash = 0xcbf29ce484222325;
        for (const Operation& operation : operation_table(isa).operations)
            for (std::uint32_t bits : run(operation, in, 0, static_cast<int>(in.a.size()))) {
                if (operation.float_result && is_nan(bits)) bits = 0x7fc00000;
                hash = (hash ^ bits) * 0x100000001b3;
            }
        EXPECT_EQ(hash, 17898978982195899402u) << name(isa);
    }
}

}  // namespace
}  // namespace tessera
