// Stable counting sort into buckets: items 0 .. n-1 grouped by a small integer key, each bucket in
// ascending order of its items. Linear time; the way hostile meshes cannot make grouping quadratic.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace tessera {

struct Buckets {
    std::vector<std::uint32_t> first;  // bucket b is items[first[b] .. first[b + 1])
    std::vector<std::uint32_t> items;

    std::size_t count() const { return first.size() - 1; }
    std::span<std::uint32_t> operator[](std::size_t b) {
        return std::span(items).subspan(first[b], first[b + 1] - first[b]);
    }
};

// key(i) is called twice for every item i below `item_count` and must be below `bucket_count`.
template <class Key>
Buckets fill_buckets(std::uint32_t item_count, std::size_t bucket_count, Key key) {
    Buckets result{std::vector<std::uint32_t>(bucket_count + 1, 0), std::vector<std::uint32_t>(item_count)};
    for (std::uint32_t i = 0; i < item_count; ++i) ++result.first[key(i) + 1];
    std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
    std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
    for (std::uint32_t i = 0; i < item_count; ++i) result.items[next[key(i)]++] = i;
    return result;
}

}  // namespace tessera
