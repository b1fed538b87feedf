// A selection of a product of factors in which every pair of values of any two factors occurs (pairwise
// testing; the greedy choice of Cohen, Dalal, Fredman and Patton, "The AETG System", 1997, without its
// random numbers: the same selection every time).
#pragma once

#include <cstddef>
#include <vector>

namespace tessera::test {

// Rows of one value per factor, 0 .. sizes[factor] - 1. At least two factors.
std::vector<std::vector<int>> all_pairs(const std::vector<int>& sizes);
// Every combination.
std::vector<std::vector<int>> full_product(const std::vector<int>& sizes);

}  // namespace tessera::test
