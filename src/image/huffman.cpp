#include "image/huffman.h"

#include <algorithm>
#include <array>

namespace tessera {
namespace {

struct Leaf {
    std::uint32_t count;
    std::uint32_t symbol;
};

// Code lengths for leaves in ascending order of count, by the method of two queues (van Leeuwen, "On the
// Construction of Huffman Trees", 1976): the two lightest nodes are always at the heads of the leaves
// and of the inner nodes, which are made in ascending order. Returns the lengths in the same order.
std::vector<int> tree_depths(const std::vector<Leaf>& leaves) {
    const std::size_t n = leaves.size();
    std::vector<std::uint64_t> weight(2 * n - 1);
    std::vector<std::size_t> parent(2 * n - 1);
    for (std::size_t i = 0; i < n; ++i) weight[i] = leaves[i].count;

    std::size_t leaf = 0, inner = n;
    for (std::size_t made = n; made < 2 * n - 1; ++made) {
        const auto lightest = [&] {
            return leaf < n && (inner == made || weight[leaf] <= weight[inner]) ? leaf++ : inner++;
        };
        const std::size_t a = lightest(), b = lightest();
        weight[made] = weight[a] + weight[b];
        parent[a] = parent[b] = made;
    }
    std::vector<int> depth(2 * n - 1);
    for (std::size_t i = 2 * n - 2; i-- > 0;) depth[i] = depth[parent[i]] + 1;
    depth.resize(n);
    return depth;
}

std::uint16_t reversed(unsigned code, int length) {
    unsigned out = 0;
    for (int i = 0; i < length; ++i) out |= (code >> i & 1u) << (length - 1 - i);
    return static_cast<std::uint16_t>(out);
}

}  // namespace

HuffmanCode make_huffman_code(std::span<const std::uint32_t> counts, int max_length) {
    std::vector<Leaf> leaves;
    for (std::uint32_t s = 0; s < counts.size(); ++s)
        if (counts[s] > 0) leaves.push_back({counts[s], s});
    for (std::uint32_t s = 0; leaves.size() < 2; ++s)
        if (leaves.empty() || leaves[0].symbol != s) leaves.push_back({1, s});
    std::sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) {
        return a.count != b.count ? a.count < b.count : a.symbol < b.symbol;
    });

    // Too deep a tree becomes flatter when the counts do: halving keeps their order and ends with all
    // equal. This costs a little against an optimal limited code, and happens to extreme counts only.
    std::vector<int> depth = tree_depths(leaves);
    while (*std::max_element(depth.begin(), depth.end()) > max_length) {
        for (Leaf& l : leaves) l.count = (l.count + 1) / 2;
        depth = tree_depths(leaves);
    }

    HuffmanCode code;
    code.bits.resize(counts.size());
    code.length.resize(counts.size());
    std::array<unsigned, 17> of_length{}, next{};
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        code.length[leaves[i].symbol] = static_cast<std::uint8_t>(depth[i]);
        ++of_length[static_cast<std::size_t>(depth[i])];
    }
    of_length[0] = 0;
    for (std::size_t l = 1; l < next.size(); ++l) next[l] = (next[l - 1] + of_length[l - 1]) << 1;
    for (std::size_t s = 0; s < counts.size(); ++s)
        if (const int l = code.length[s]; l > 0) code.bits[s] = reversed(next[static_cast<std::size_t>(l)]++, l);
    return code;
}

}  // namespace tessera
