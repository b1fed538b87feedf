#include "image/deflate.h"

#include "image/huffman.h"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace tessera {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Through libdeflate, which refuses every stream that is not valid.
void expect_inflates_to(const Bytes& stream, const Bytes& expected, const char* what) {
    Bytes out(expected.size() + 1);
    std::size_t size = 0, read = 0;
    auto* inflater = libdeflate_alloc_decompressor();
    const auto result =
        libdeflate_deflate_decompress_ex(inflater, stream.data(), stream.size(), out.data(), out.size(), &read, &size);
    libdeflate_free_decompressor(inflater);
    ASSERT_EQ(result, LIBDEFLATE_SUCCESS) << what;
    EXPECT_EQ(read, stream.size()) << what;
    out.resize(size);
    EXPECT_EQ(out, expected) << what;
}

void expect_round_trip(const Bytes& in, const char* what) {
    for (std::size_t pixel = 1; pixel <= 8; ++pixel) {
        Bytes stream;
        deflate_fast(in, pixel, stream);
        deflate_end(stream);
        expect_inflates_to(stream, in, what);
        EXPECT_LE(stream.size(), in.size() + 5 * (in.size() / 65535 + 2)) << what;
    }
}

TEST(Deflate, RoundTripsEveryKindOfBytes) {
    std::mt19937 random(1);
    for (const std::size_t size : {0, 1, 2, 5, 6, 7, 8, 9, 257, 258, 259, 264, 1000, 65535, 65536, 200000}) {
        Bytes noise(size), few(size), sloped(size), runs(size);
        std::uint8_t held = 0;
        for (std::size_t i = 0; i < size; ++i) {
            noise[i] = static_cast<std::uint8_t>(random());
            few[i] = static_cast<std::uint8_t>(random() % 3);
            sloped[i] = static_cast<std::uint8_t>(i % 4);
            if (random() % 40 == 0) held = static_cast<std::uint8_t>(random());
            runs[i] = held;
        }
        expect_round_trip(noise, "noise");
        expect_round_trip(few, "few values");
        expect_round_trip(sloped, "a period of four");
        expect_round_trip(runs, "runs");
        expect_round_trip(Bytes(size), "zeros");
        expect_round_trip(Bytes(size, 0xff), "one value");
    }
}

TEST(Deflate, EveryMatchLengthIsCoded) {
    // Runs of each length from none to beyond the longest match, between bytes that differ.
    Bytes in;
    for (std::size_t run = 0; run < 600; ++run) {
        in.insert(in.end(), run, static_cast<std::uint8_t>(run % 2));
        in.push_back(static_cast<std::uint8_t>(100 + run % 100));
    }
    expect_round_trip(in, "runs of every length");
}

TEST(Deflate, SkewedCountsKeepTheirCodesShort) {
    // Fibonacci counts make the deepest Huffman tree: 24 levels without a limit.
    Bytes in;
    std::uint32_t a = 1, b = 1;
    for (int symbol = 0; symbol < 24; ++symbol) {
        in.insert(in.end(), a, static_cast<std::uint8_t>(symbol * 7));
        b += a;
        std::swap(a, b);
    }
    std::shuffle(in.begin(), in.end(), std::mt19937(2));
    expect_round_trip(in, "Fibonacci counts");
}

TEST(Deflate, PiecesJoinToOneStream) {
    std::mt19937 random(3);
    Bytes all, stream;
    for (const std::size_t size : {100, 0, 70000, 3, 5000}) {
        Bytes piece(size);
        for (std::uint8_t& v : piece) v = static_cast<std::uint8_t>(random() % 5);
        if (size == 5000)
            deflate_stored(piece, stream);
        else
            deflate_fast(piece, 3, stream);
        all.insert(all.end(), piece.begin(), piece.end());
    }
    deflate_end(stream);
    expect_inflates_to(stream, all, "pieces");
}

TEST(Deflate, RunsCostFewBits) {
    Bytes stream;
    deflate_fast(Bytes(258 * 1000), 4, stream);
    EXPECT_LT(stream.size(), 600u);  // 1000 matches of two to four bits, and the codes
}

TEST(Huffman, CodesAreCompleteAndNearTheEntropy) {
    std::mt19937 random(4);
    for (int round = 0; round < 200; ++round) {
        std::vector<std::uint32_t> counts(2 + random() % 285);
        for (std::uint32_t& c : counts)
            c = random() % 3 == 0 ? 0 : 1 + static_cast<std::uint32_t>(random()) % (1u << random() % 18);
        const int limit = round % 2 == 0 ? 15 : 9;
        const HuffmanCode code = make_huffman_code(counts, limit);
        double kraft = 0, bits = 0, entropy = 0;
        const double total = std::accumulate(counts.begin(), counts.end(), 0.0);
        for (std::size_t s = 0; s < counts.size(); ++s) {
            ASSERT_TRUE(counts[s] == 0 || code.length[s] > 0);
            if (code.length[s] == 0) continue;
            ASSERT_LE(code.length[s], limit);
            kraft += std::exp2(-code.length[s]);
            bits += counts[s] * static_cast<double>(code.length[s]);
            if (counts[s] > 0) entropy += counts[s] * std::log2(total / counts[s]);
        }
        EXPECT_EQ(kraft, 1);
        EXPECT_GE(bits, entropy - 1e-6);
        EXPECT_TRUE(limit < 15 || bits < entropy + total);  // Shannon: less than a bit a symbol more
    }
}

TEST(Huffman, LimitsTheLengthOfFibonacciCounts) {
    std::vector<std::uint32_t> counts{1, 1};
    while (counts.size() < 40) counts.push_back(counts[counts.size() - 1] + counts[counts.size() - 2]);
    for (const int limit : {7, 9, 15}) {
        const HuffmanCode code = make_huffman_code(counts, limit);
        double kraft = 0;
        for (const std::uint8_t l : code.length) {
            EXPECT_TRUE(l >= 1 && l <= limit);
            kraft += std::exp2(-l);
        }
        EXPECT_EQ(kraft, 1);
    }
}

TEST(Huffman, TwoSymbolsAtLeast) {
    for (std::size_t used = 0; used < 4; ++used) {
        std::vector<std::uint32_t> counts(4);
        if (used < 3) counts[used] = 10;
        const HuffmanCode code = make_huffman_code(counts, 15);
        EXPECT_EQ(std::count(code.length.begin(), code.length.end(), 1), 2);
    }
}

}  // namespace
}  // namespace tessera
