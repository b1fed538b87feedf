#include "image/deflate.h"

#include "image/huffman.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "bits are gathered in little-endian words");

constexpr std::size_t kLiterals = 256, kEndOfBlock = 256, kSymbols = 286, kDistances = 30, kLengthSymbols = 19;
constexpr std::size_t kMaxMatch = 258;
// Shorter matches cost more bits than the few that well predicted literals take.
constexpr std::size_t kMinMatch = 6;
// The order in which the lengths of the code for code lengths are stored (section 3.2.7).
constexpr std::array<std::uint8_t, kLengthSymbols> kLengthOrder{16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                                11, 4,  12, 3, 13, 2, 14, 1, 15};

// A symbol with the number and value of the extra bits that follow it.
struct Extra {
    std::uint16_t symbol = 0, value = 0;
    int bits = 0;
};

// Match length 3 .. 258 (section 3.2.5): four symbols for each number of extra bits.
Extra length_symbol(std::size_t length) {
    if (length == kMaxMatch) return {285, 0, 0};
    const auto l = static_cast<unsigned>(length - 3);
    if (l < 8) return {static_cast<std::uint16_t>(257 + l), 0, 0};
    const int bits = std::bit_width(l) - 3;
    return {static_cast<std::uint16_t>(257 + 4 * bits + static_cast<int>(l >> bits)),
            static_cast<std::uint16_t>(l & ((1u << bits) - 1)), bits};
}

// Distance 1 .. 8 (section 3.2.5).
Extra distance_symbol(std::size_t distance) {
    const auto d = static_cast<unsigned>(distance - 1);
    if (d < 4) return {static_cast<std::uint16_t>(d), 0, 0};
    return {static_cast<std::uint16_t>(2 + (d >> 1)), static_cast<std::uint16_t>(d & 1), 1};
}

// Gathers bits, lowest first. The caller keeps room for 8 bytes beyond what it writes.
class BitWriter {
  public:
    explicit BitWriter(std::uint8_t* to) : to_(to) {}
    // At most 56 bits between two flushes.
    void put(std::uint64_t bits, int count) {
        held_ |= bits << count_;
        count_ += count;
    }
    void flush() {
        std::memcpy(to_, &held_, 8);
        to_ += count_ >> 3;
        held_ >>= count_ & ~7;
        count_ &= 7;
    }
    // Fills up with zeros to a byte border.
    std::uint8_t* finish() {
        count_ = (count_ + 7) & ~7;
        flush();
        return to_;
    }

  private:
    std::uint8_t* to_;
    std::uint64_t held_ = 0;
    int count_ = 0;
};

// `literals` bytes as they are, then a match of `length` (0: none, at the end).
struct Step {
    std::uint32_t literals;
    std::uint32_t length;
};

std::size_t equal_bytes(const std::uint8_t* a, const std::uint8_t* b, std::size_t limit) {
    std::size_t n = 0;
    for (; n + 8 <= limit; n += 8) {
        std::uint64_t x, y;
        std::memcpy(&x, a + n, 8);
        std::memcpy(&y, b + n, 8);
        if (x != y) return n + static_cast<std::size_t>(std::countr_zero(x ^ y) / 8);
    }
    while (n < limit && a[n] == b[n]) ++n;
    return n;
}

// Where bytes equal those `distance` before them.
std::vector<Step> find_matches(std::span<const std::uint8_t> in, std::size_t distance) {
    std::vector<Step> steps;
    const std::uint8_t* p = in.data();
    std::size_t begin = 0, i = distance;
    while (i + 8 <= in.size()) {
        std::uint64_t x, y;
        std::memcpy(&x, p + i, 8);
        std::memcpy(&y, p + i - distance, 8);
        const std::uint64_t differing = x ^ y;
        if ((differing & 0xffffffffffffu) != 0) {
            // No match of six bytes begins before the last of them that differs.
            i += static_cast<std::size_t>(64 - std::countl_zero(differing & 0xffffffffffffu) + 7) / 8;
            continue;
        }
        const std::size_t length = equal_bytes(p + i, p + i - distance, std::min(kMaxMatch, in.size() - i));
        steps.push_back({static_cast<std::uint32_t>(i - begin), static_cast<std::uint32_t>(length)});
        i += length;
        begin = i;
    }
    steps.push_back({static_cast<std::uint32_t>(in.size() - begin), 0});
    return steps;
}
static_assert(kMinMatch == 6, "find_matches() looks at six bytes");

// The code lengths of literals and distances as symbols 0 .. 18 with their repeats (section 3.2.7).
std::vector<Extra> pack_lengths(const std::vector<std::uint8_t>& lengths) {
    std::vector<Extra> packed;
    for (std::size_t i = 0; i < lengths.size();) {
        const std::uint8_t l = lengths[i];
        std::size_t run = 1;
        while (i + run < lengths.size() && lengths[i + run] == l) ++run;
        if (l == 0 && run >= 3) {
            run = std::min<std::size_t>(run, 138);
            packed.push_back(run < 11 ? Extra{17, static_cast<std::uint16_t>(run - 3), 3}
                                      : Extra{18, static_cast<std::uint16_t>(run - 11), 7});
        } else if (run >= 4) {
            run = std::min<std::size_t>(run, 7);
            packed.push_back({l, 0, 0});
            packed.push_back({16, static_cast<std::uint16_t>(run - 4), 2});
        } else {
            run = 1;
            packed.push_back({l, 0, 0});
        }
        i += run;
    }
    return packed;
}

void put_symbol(BitWriter& writer, const HuffmanCode& code, const Extra& e) {
    const int length = code.length[e.symbol];
    writer.put(code.bits[e.symbol] | static_cast<std::uint64_t>(e.value) << length, length + e.bits);
}

void put_header(BitWriter& writer, const HuffmanCode& symbols, const HuffmanCode& distances) {
    std::vector<std::uint8_t> lengths = symbols.length;
    lengths.insert(lengths.end(), distances.length.begin(), distances.length.end());
    const std::vector<Extra> packed = pack_lengths(lengths);
    std::array<std::uint32_t, kLengthSymbols> counts{};
    for (const Extra& e : packed) ++counts[e.symbol];
    const HuffmanCode code = make_huffman_code(counts, 7);

    writer.put(0b100, 3);  // not final; dynamic codes
    writer.put(kSymbols - 257, 5);
    writer.put(kDistances - 1, 5);
    writer.put(kLengthSymbols - 4, 4);
    for (const std::uint8_t s : kLengthOrder) {
        writer.put(code.length[s], 3);
        writer.flush();
    }
    for (const Extra& e : packed) {
        put_symbol(writer, code, e);
        writer.flush();
    }
}

struct Coded {
    std::uint16_t bits, length;
};

void put_literals(BitWriter& writer, const std::array<Coded, kLiterals>& code, const std::uint8_t* p, std::size_t n) {
    // A code has at most 15 bits: three of them fit between flushes.
    for (; n >= 3; n -= 3, p += 3) {
        const Coded a = code[p[0]], b = code[p[1]], c = code[p[2]];
        writer.put(a.bits, a.length);
        writer.put(b.bits, b.length);
        writer.put(c.bits, c.length);
        writer.flush();
    }
    for (; n > 0; --n, ++p) writer.put(code[*p].bits, code[*p].length);
    writer.flush();
}

std::array<std::uint32_t, kSymbols> count_symbols(std::span<const std::uint8_t> in, const std::vector<Step>& steps) {
    // Two tables, so that equal bytes in a row do not wait for each other.
    std::array<std::uint32_t, kLiterals> even{}, odd{};
    std::array<std::uint32_t, kSymbols> counts{};
    const std::uint8_t* p = in.data();
    for (const Step& step : steps) {
        std::size_t n = step.literals;
        for (; n >= 2; n -= 2, p += 2) ++even[p[0]], ++odd[p[1]];
        if (n > 0) ++even[*p++];
        if (step.length > 0) ++counts[length_symbol(step.length).symbol];
        p += step.length;
    }
    for (std::size_t i = 0; i < kLiterals; ++i) counts[i] = even[i] + odd[i];
    counts[kEndOfBlock] = 1;
    return counts;
}

}  // namespace

void deflate_stored(std::span<const std::uint8_t> in, std::vector<std::uint8_t>& out) {
    while (!in.empty()) {
        const std::size_t n = std::min<std::size_t>(in.size(), 0xffff);
        const auto low = static_cast<std::uint8_t>(n & 0xff), high = static_cast<std::uint8_t>(n >> 8);
        const std::uint8_t head[5] = {0, low, high, static_cast<std::uint8_t>(~low), static_cast<std::uint8_t>(~high)};
        out.insert(out.end(), head, head + 5);
        out.insert(out.end(), in.begin(), in.begin() + static_cast<std::ptrdiff_t>(n));
        in = in.subspan(n);
    }
}

void deflate_end(std::vector<std::uint8_t>& out) {
    constexpr std::uint8_t kFinal[5] = {1, 0, 0, 0xff, 0xff};
    out.insert(out.end(), kFinal, kFinal + 5);
}

void deflate_fast(std::span<const std::uint8_t> in, std::size_t pixel_bytes, std::vector<std::uint8_t>& out) {
    const std::vector<Step> steps = find_matches(in, pixel_bytes);
    const auto counts = count_symbols(in, steps);
    const HuffmanCode symbols = make_huffman_code(counts, 15);
    const Extra distance = distance_symbol(pixel_bytes);
    std::array<std::uint32_t, kDistances> distance_counts{};
    distance_counts[distance.symbol] = 1;
    const HuffmanCode distances = make_huffman_code(distance_counts, 15);

    std::uint64_t bits = 0;
    for (std::size_t s = 0; s < kSymbols; ++s) bits += std::uint64_t{counts[s]} * symbols.length[s];
    for (const Step& step : steps)
        if (step.length > 0) bits += static_cast<unsigned>(length_symbol(step.length).bits + 1 + distance.bits);
    // The codes of the header take at most 7 + 7 bits for each of 316 lengths.
    constexpr std::size_t kHeaderBytes = 600, kMargin = 32;
    if (bits / 8 >= in.size()) return deflate_stored(in, out);

    const std::size_t old = out.size();
    out.resize(old + bits / 8 + kHeaderBytes + kMargin);
    BitWriter writer(out.data() + old);
    put_header(writer, symbols, distances);
    std::array<Coded, kLiterals> literals{};
    for (std::size_t i = 0; i < kLiterals; ++i) literals[i] = {symbols.bits[i], symbols.length[i]};
    const std::uint8_t* p = in.data();
    for (const Step& step : steps) {
        put_literals(writer, literals, p, step.literals);
        p += step.literals + step.length;
        if (step.length == 0) break;
        put_symbol(writer, symbols, length_symbol(step.length));
        put_symbol(writer, distances, distance);
        writer.flush();
    }
    writer.put(symbols.bits[kEndOfBlock], symbols.length[kEndOfBlock]);
    writer.put(0, 3);  // an empty stored block (not final) begins at the next byte border
    std::uint8_t* end = writer.finish();
    constexpr std::uint8_t kEmpty[4] = {0, 0, 0xff, 0xff};
    std::memcpy(end, kEmpty, 4);
    out.resize(static_cast<std::size_t>(end + 4 - out.data()));
    // Short or noisy input may not pay for the header with the codes.
    if (out.size() - old > in.size() + 5) {
        out.resize(old);
        deflate_stored(in, out);
    }
}

}  // namespace tessera
