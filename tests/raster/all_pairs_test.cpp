#include "raster/all_pairs.h"

#include <gtest/gtest.h>

#include <set>

namespace tessera::test {
namespace {

TEST(AllPairs, EveryPairOccursInFewRows) {
    for (const std::vector<int>& sizes :
         {std::vector<int>{2, 2}, {3, 3, 3}, {40, 4, 4, 3, 2, 2}, {5, 1, 7}, {2, 2, 2, 2, 2, 2, 2, 2}}) {
        const std::vector<std::vector<int>> rows = all_pairs(sizes);
        std::size_t product = 1;
        int largest = 1, second = 1;
        for (const int s : sizes) {
            product *= static_cast<std::size_t>(s);
            if (s > largest)
                second = std::exchange(largest, s);
            else if (s > second)
                second = s;
        }
        for (std::size_t f = 0; f < sizes.size(); ++f)
            for (std::size_t g = f + 1; g < sizes.size(); ++g) {
                std::set<std::pair<int, int>> seen;
                for (const std::vector<int>& row : rows) {
                    ASSERT_GE(row[f], 0);
                    ASSERT_LT(row[f], sizes[f]);
                    seen.insert({row[f], row[g]});
                }
                EXPECT_EQ(seen.size(), static_cast<std::size_t>(sizes[f] * sizes[g]));
            }
        EXPECT_LE(rows.size(), product);
        EXPECT_LE(rows.size(), static_cast<std::size_t>(largest * second) * 3 / 2 + 8) << "hardly a selection";
    }
}

TEST(AllPairs, TheProductHasEveryCombinationOnce) {
    const std::vector<std::vector<int>> rows = full_product({3, 1, 4, 2});
    EXPECT_EQ(rows.size(), 24u);
    EXPECT_EQ(std::set<std::vector<int>>(rows.begin(), rows.end()).size(), 24u);
    for (const std::vector<int>& row : rows) EXPECT_TRUE(row[0] < 3 && row[1] < 1 && row[2] < 4 && row[3] < 2);
}

}  // namespace
}  // namespace tessera::test
