#include "trace/duplicates.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace tessera {
namespace {

constexpr std::size_t kChunk = 1 << 16;

// 0 and -0 have one hash.
std::uint32_t position_hash(const float* p) {
    const std::uint64_t x = std::bit_cast<std::uint32_t>(p[0] + 0.0f), y = std::bit_cast<std::uint32_t>(p[1] + 0.0f),
                        z = std::bit_cast<std::uint32_t>(p[2] + 0.0f);
    std::uint64_t h = (x | y << 32) * 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 32) ^ z * 0xbf58476d1ce4e5b9u) * 0xd6e8feb86659fd93u;
    return static_cast<std::uint32_t>(h >> 32);
}

// A key per triangle of a set: the same for every order of its corners.
void make_keys(const TriangleSet& set, Arena& arena, std::vector<std::uint32_t>& hashes, std::uint32_t* keys) {
    const auto chunks = [&](std::size_t count, const auto& body) {
        arena.for_each((count + kChunk - 1) / kChunk, [&](std::size_t c) {
            for (std::size_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i) body(i);
        });
    };
    hashes.resize(set.vertex_count);
    std::uint32_t* hash = hashes.data();
    chunks(set.vertex_count, [&](std::size_t v) { hash[v] = position_hash(set.positions + 3 * v); });
    chunks(set.triangle_count, [&](std::size_t t) {
        const std::uint32_t* v = set.triangles + 3 * t;
        keys[t] = hash[v[0]] + hash[v[1]] + hash[v[2]];
    });
}

// A set of keys that may hold a few more than were put in: a bit each, shared by chance.
class KeyFilter {
  public:
    explicit KeyFilter(std::size_t keys)
        : shift_(32 - std::clamp(static_cast<int>(std::bit_width(16 * keys)), 6, 32)),
          bits_((std::size_t{1} << (32 - shift_)) / 64) {}

    bool has(std::uint32_t key) const { return (bits_[place(key) / 64] >> place(key) % 64 & 1u) != 0; }
    void add(std::uint32_t key) { bits_[place(key) / 64] |= std::uint64_t{1} << place(key) % 64; }

  private:
    std::size_t place(std::uint32_t key) const { return (key * 0x85ebca6bu) >> shift_; }

    int shift_;
    std::vector<std::uint64_t> bits_;
};

// The keys that occur more than once and, by chance, a few that do not.
std::vector<std::uint32_t> repeated_keys(const std::vector<std::uint32_t>& keys) {
    KeyFilter seen(keys.size());
    std::vector<std::uint32_t> repeated;
    for (const std::uint32_t key : keys) {
        if (seen.has(key)) repeated.push_back(key);
        seen.add(key);
    }
    return repeated;
}

enum class Relation { kApart, kSame, kMirrored };

class Places {
  public:
    Places(std::span<const TriangleSet> sets, const std::vector<std::uint32_t>& keys)
        : sets_(sets),
          shift_(32 - std::clamp(static_cast<int>(std::bit_width(2 * keys.size())), 4, 32)),
          known_(keys.size()) {
        slots_.resize(std::size_t{1} << (32 - shift_));
        for (const std::uint32_t key : keys) {
            Slot& slot = find(key);
            slot = {key, slot.first == kEmpty ? kNone : slot.first};
            known_.add(key);
        }
    }

    // Whether the triangle is hidden by those that were added before. Keys but those of the constructor are not.
    bool add(std::uint32_t key, std::uint32_t set, std::uint32_t triangle) {
        if (!known_.has(key)) return false;  // most: that stays in the cache
        Slot& slot = find(key);
        if (slot.first == kEmpty) return false;
        const unsigned sides = sets_[set].front | static_cast<unsigned>(sets_[set].back) << 8;
        for (std::uint32_t i = slot.first; i != kNone; i = places_[i].next) {
            Place& place = places_[i];
            const Relation relation = relate(place, set, triangle);
            if (relation == Relation::kApart) continue;
            const unsigned own = relation == Relation::kSame ? sides : (sides >> 8 | (sides & 255u) << 8);
            const bool hidden = (own & ~place.sides) == 0;
            place.sides |= own;
            return hidden;
        }
        places_.push_back({set, triangle, sides, slot.first});
        slot.first = static_cast<std::uint32_t>(places_.size() - 1);
        return false;
    }

  private:
    static constexpr std::uint32_t kEmpty = 0, kNone = 0xffffffffu;  // the first place is never used
    struct Slot {
        std::uint32_t key = 0, first = kEmpty;  // its chain of places_, or kNone
    };
    struct Place {
        std::uint32_t set, triangle;
        unsigned sides;  // which are seen of those that lie here: front, and << 8 back, of this triangle
        std::uint32_t next;
    };

    Slot& find(std::uint32_t key) {
        std::size_t at = (key * 0x9e3779b1u) >> shift_;
        while (slots_[at].first != kEmpty && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
        return slots_[at];
    }

    const float* corner(std::uint32_t set, std::uint32_t triangle, std::uint32_t i) const {
        const TriangleSet& s = sets_[set];
        return s.positions + 3 * std::size_t{s.triangles[3 * std::size_t{triangle} + i]};
    }

    Relation relate(const Place& place, std::uint32_t set, std::uint32_t triangle) const {
        const float *a[3], *b[3];
        for (std::uint32_t i = 0; i < 3; ++i) {
            a[i] = corner(place.set, place.triangle, i);
            b[i] = corner(set, triangle, i);
        }
        const auto equal = [](const float* p, const float* q) { return p[0] == q[0] && p[1] == q[1] && p[2] == q[2]; };
        for (std::size_t i = 0; i < 3; ++i) {
            if (!equal(a[0], b[i])) continue;
            const float *after = b[(i + 1) % 3], *before = b[(i + 2) % 3];
            if (equal(a[1], after) && equal(a[2], before)) return Relation::kSame;
            if (equal(a[1], before) && equal(a[2], after)) return Relation::kMirrored;
        }
        return Relation::kApart;
    }

    std::span<const TriangleSet> sets_;
    int shift_;
    KeyFilter known_;
    std::vector<Slot> slots_;
    std::vector<Place> places_{1};
};

}  // namespace

std::vector<std::vector<std::uint32_t>> find_duplicates(std::span<const TriangleSet> sets, Arena& arena) {
    const auto counts = [](const TriangleSet& set) { return (set.front | set.back) != 0; };
    std::size_t total = 0;
    for (const TriangleSet& set : sets)
        if (counts(set)) total += set.triangle_count;
    if (total < 2) return {};
    std::vector<std::uint32_t> keys(total), hashes;
    std::uint32_t* of_set = keys.data();
    for (const TriangleSet& set : sets) {
        if (!counts(set)) continue;
        make_keys(set, arena, hashes, of_set);
        of_set += set.triangle_count;
    }
    const std::vector<std::uint32_t> repeated = repeated_keys(keys);
    if (repeated.empty()) return {};
    Places places(sets, repeated);
    std::vector<std::vector<std::uint32_t>> dropped(sets.size());
    bool any = false;
    const std::uint32_t* key = keys.data();
    for (std::uint32_t s = 0; s < sets.size(); ++s) {
        if (!counts(sets[s])) continue;
        for (std::uint32_t t = 0; t < sets[s].triangle_count; ++t) {
            if (!places.add(*key++, s, t)) continue;
            dropped[s].push_back(t);
            any = true;
        }
    }
    if (!any) dropped.clear();
    return dropped;
}

}  // namespace tessera
