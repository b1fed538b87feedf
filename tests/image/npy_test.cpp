// NumPy's arrays: the bytes that the format's definition demands, NumPy itself where it is installed, and
// files that lie.
#include <tessera/error.h>
#include <tessera/planes.h>

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

namespace tessera {
namespace {

std::string text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

// A file of version 1.0 with this dictionary.
std::vector<std::byte> file_with(const std::string& dictionary, std::size_t value_bytes) {
    std::string file("\x93NUMPY\x01\0", 8);
    file += static_cast<char>(dictionary.size() & 0xff);
    file += static_cast<char>(dictionary.size() >> 8);
    return bytes_of(file + dictionary + std::string(value_bytes, '\1'));
}

TEST(Npy, Fb1BytesAreTheFormats) {
    const std::array<float, 6> values{0, 1, -2, 0.5f, 3, std::numeric_limits<float>::infinity()};
    std::string expected("\x93NUMPY\x01\x00\x76\x00", 10);  // 118 bytes of header: values begin at 128
    expected += "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
    expected.resize(127, ' ');
    expected += '\n';
    expected += std::string(
        "\0\0\0\0"
        "\0\0\x80\x3f"
        "\0\0\0\xc0"
        "\0\0\0\x3f"
        "\0\0\x40\x40"
        "\0\0\x80\x7f",
        24);
    EXPECT_EQ(text_of(encode_npy(3, 2, 1, NpyType::kF4, values.data())), expected);

    const std::array<std::uint16_t, 3> three{0x0102, 0x0304, 0x0506};
    const std::string file = text_of(encode_npy(1, 1, 3, NpyType::kU2, three.data()));
    EXPECT_EQ(file.substr(10, 61), "{'descr': '<u2', 'fortran_order': False, 'shape': (1, 1, 3), ");
    EXPECT_EQ(file.substr(128), "\x02\x01\x04\x03\x06\x05");
}

TEST(Npy, Fb1RoundTripsEveryTypeAndShape) {
    std::mt19937 random(3);
    for (const NpyType type : {NpyType::kU1, NpyType::kU2, NpyType::kU4, NpyType::kF2, NpyType::kF4})
        for (const auto& [width, height, components] :
             {std::array{1, 1, 1}, std::array{16384, 1, 1}, std::array{7, 13, 3}, std::array{5, 1, 64}}) {
            std::vector<std::byte> values(static_cast<std::size_t>(width * height * components) *
                                          bytes_per_value(type));
            for (std::byte& b : values) b = static_cast<std::byte>(random());
            const std::vector<std::byte> file = encode_npy(width, height, components, type, values.data());
            EXPECT_EQ((file.size() - values.size()) % 64, 0u);
            ASSERT_TRUE(is_npy(file));
            const NpyArray array = decode_npy(file);
            EXPECT_EQ(std::tie(array.width, array.height, array.components), std::tie(width, height, components));
            EXPECT_EQ(array.type, type);
            EXPECT_EQ(array.values, values);
        }
}

TEST(Npy, ImagesComeWithTheirChannels) {
    const auto shape_of = [](PixelFormat format) {
        const NpyArray a = decode_npy(encode_npy(Image(3, 2, format)));
        return std::tuple(a.width, a.height, a.components, a.type);
    };
    EXPECT_EQ(shape_of(PixelFormat::kRgba8), std::tuple(3, 2, 4, NpyType::kU1));
    EXPECT_EQ(shape_of(PixelFormat::kRgba16), std::tuple(3, 2, 4, NpyType::kU2));
    EXPECT_EQ(shape_of(PixelFormat::kRgba32f), std::tuple(3, 2, 4, NpyType::kF4));
    EXPECT_EQ(shape_of(PixelFormat::kRg32f), std::tuple(3, 2, 2, NpyType::kF4));
    EXPECT_EQ(shape_of(PixelFormat::kRgb32f), std::tuple(3, 2, 3, NpyType::kF4));
    EXPECT_EQ(shape_of(PixelFormat::kF32), std::tuple(3, 2, 1, NpyType::kF4));
    EXPECT_EQ(shape_of(PixelFormat::kU32), std::tuple(3, 2, 1, NpyType::kU4));
}

// Runs a Python program; nothing when there is no Python with NumPy. `folder` becomes its first argument.
std::optional<std::string> run_numpy(const std::string& program, const std::filesystem::path& folder) {
    std::ofstream(folder / "program.py") << program;
    for (const char* python : {"python3", "/usr/bin/python3"}) {
        std::string command(python);
        if (std::system((command + " -c 'import numpy' 2>/dev/null").c_str()) != 0) continue;
        command.append(" '").append((folder / "program.py").string()).append("' '").append(folder.string()).append("'");
        std::FILE* pipe = ::popen(command.c_str(), "r");
        std::string said;
        for (int c; (c = std::fgetc(pipe)) != EOF;) said += static_cast<char>(c);
        EXPECT_EQ(::pclose(pipe), 0);
        return said;
    }
    return {};
}

class NpyFolder : public ::testing::Test {
  protected:
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("tessera-npy-" + std::to_string(::getpid()));
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void write(const char* name, std::span<const std::byte> bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << text_of(bytes);
    }
    std::vector<std::byte> read(const char* name) const {
        std::ifstream in(folder_ / name, std::ios::binary);
        return bytes_of(std::string(std::istreambuf_iterator<char>(in), {}));
    }
};

TEST_F(NpyFolder, Fb1NumPyReadsAndWritesTheSame) {
    const std::array<float, 6> floats{0, 1, -2, 0.5f, 3, std::numeric_limits<float>::infinity()};
    const std::array<std::uint32_t, 2> ids{4294967295u, 7};
    const std::array<std::uint16_t, 6> halves{0x3c00, 0xc000, 0x7bff, 0x0001, 0x8000, 0x7c00};
    write("f4.npy", encode_npy(3, 2, 1, NpyType::kF4, floats.data()));
    write("u4.npy", encode_npy(1, 2, 1, NpyType::kU4, ids.data()));
    write("f2.npy", encode_npy(2, 1, 3, NpyType::kF2, halves.data()));
    const auto said = run_numpy(R"(
import sys, numpy as np
for name in ('f4', 'u4', 'f2'):
    a = np.load(sys.argv[1] + '/' + name + '.npy')
    print(a.dtype.str, a.shape, a.flags.c_contiguous, a.tolist())
np.save(sys.argv[1] + '/saved.npy', np.arange(24, dtype=np.uint16).reshape(2, 4, 3))
np.save(sys.argv[1] + '/fortran.npy', np.asfortranarray(np.zeros((3, 2), dtype=np.float32)))
np.lib.format.write_array(open(sys.argv[1] + '/v2.npy', 'wb'), np.full((1, 2), 9, np.uint8), version=(2, 0))
)",
                                folder_);
    if (!said) GTEST_SKIP() << "Python with NumPy is not installed";
    EXPECT_EQ(*said,
              "<f4 (2, 3) True [[0.0, 1.0, -2.0], [0.5, 3.0, inf]]\n"
              "<u4 (2, 1) True [[4294967295], [7]]\n"
              "<f2 (1, 2, 3) True [[[1.0, -2.0, 65504.0], [5.960464477539063e-08, -0.0, inf]]]\n");
    std::array<std::uint16_t, 24> expected{};
    for (std::size_t i = 0; i < 24; ++i) expected[i] = static_cast<std::uint16_t>(i);
    EXPECT_EQ(read("saved.npy"), encode_npy(4, 2, 3, NpyType::kU2, expected.data())) << "byte for byte";
    const NpyArray second = decode_npy(read("v2.npy"));
    EXPECT_EQ(text_of(second.values), "\t\t");
    EXPECT_THROW(decode_npy(read("fortran.npy")), Error);
}

std::string refusal_of(const std::vector<std::byte>& file, ErrorCode code = ErrorCode::kInput) {
    try {
        decode_npy(file);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        return e.message();
    }
    return "accepted";
}

TEST(Npy, RefusesByName) {
    const auto with = [](const char* descr, const char* order, const char* shape) {
        return file_with(
            std::string("{'descr': '") + descr + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }", 4);
    };
    EXPECT_EQ(decode_npy(with("<f4", "False", "(1, 1)")).width, 1);
    EXPECT_NE(refusal_of(with(">f4", "False", "(1, 1)")).find("type >f4"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f8", "False", "(1, 1)")).find("type <f8"), std::string::npos);
    EXPECT_NE(refusal_of(with("\x1b[31m", "False", "(1, 1)")).find("type unknown"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "True", "(1, 1)")).find("Fortran order"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "False", "(1,)")).find("1 dimensions"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "False", "()")).find("0 dimensions"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "False", "(1, 1, 1, 1)")).find("more than 3"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "False", "(1, 1, 65)")).find("65 components"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "False", "(1, 1, 0)")).find("0 components"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "False", "(1, 2)")).find("4 bytes of values instead of 8"), std::string::npos);
    EXPECT_NE(refusal_of(with("|u1", "False", "(1, 2)")).find("4 bytes of values instead of 2"), std::string::npos);
    EXPECT_NE(refusal_of(with("<f4", "False", "(0, 1)")), "accepted");
    for (const char* shape : {"(999999999, 999999999)", "(1000000000, 1)", "(99999999999999999999, 1)", "(20000, 1)"})
        EXPECT_NE(refusal_of(with("<f4", "False", shape), ErrorCode::kLimit), "accepted") << shape;
    EXPECT_THROW(decode_npy(with("<f4", "False", "(1, 1)"), 0), Error);
}

TEST(Npy, RefusesDamage) {
    const char* const kDamaged[] = {
        "",
        "{",
        "{}",
        "{'descr': '<f4', 'fortran_order': False}",
        "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1)}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1), 'more': 1}",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1), } 1",
        "{'descr': '<f4', 'fortran_order': Falsehood, 'shape': (1, 1), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1  1), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (-1, 1), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1), ",
        "{'descr': '<f4, 'fortran_order': False, 'shape': (1, 1), }",
        "{'descr': '\\x3cf4', 'fortran_order': False, 'shape': (1, 1), }",
        "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1, 1), }",
    };
    for (const char* header : kDamaged) EXPECT_NE(refusal_of(file_with(header, 4)), "accepted") << header;

    const float value = 1;
    const std::vector<std::byte> good = encode_npy(1, 1, 1, NpyType::kF4, &value);
    for (std::size_t length = 0; length < good.size(); ++length)
        EXPECT_NE(refusal_of({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)}), "accepted") << length;
    // Whatever a byte turns into: an array or an Error.
    for (std::size_t at = 0; at < 128; ++at)
        for (int byte = 0; byte < 256; ++byte) {
            std::vector<std::byte> file = good;
            file[at] = static_cast<std::byte>(byte);
            try {
                EXPECT_EQ(decode_npy(file).values.size(), 4u);
            } catch (const Error&) {
            }
        }
}

TEST(Npy, ComparesInTheUnitOfTheValues) {
    const auto array = [](NpyType type, int width, const auto& values) {
        return decode_npy(encode_npy(width, 1, static_cast<int>(std::size(values)) / width, type, std::data(values)));
    };
    constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
    const float a[]{1, 2, kInfinity, kNan}, b[]{1, 2.5f, kInfinity, kNan}, c[]{1, 2, 3, 4};
    ImageDifference d = compare_arrays(array(NpyType::kF4, 4, a), array(NpyType::kF4, 4, b));
    EXPECT_EQ(d.differing_pixels, 1u);
    EXPECT_EQ(d.max_error, 0.5);
    EXPECT_EQ(d.mean_error, 0.125);
    EXPECT_EQ(compare_arrays(array(NpyType::kF4, 2, a), array(NpyType::kF4, 2, b), 0.5).differing_pixels, 0u);
    EXPECT_EQ(compare_arrays(array(NpyType::kF4, 2, a), array(NpyType::kF4, 2, c)).differing_pixels, 1u)
        << "pixels of two";
    EXPECT_EQ(compare_arrays(array(NpyType::kF4, 4, a), array(NpyType::kF4, 4, c)).max_error, kInfinity);

    const std::uint32_t low[]{0, 5}, high[]{4294967295u, 5};
    EXPECT_EQ(compare_arrays(array(NpyType::kU4, 2, low), array(NpyType::kU4, 2, high)).max_error, 4294967295.0);

    // Halves: 1, 0.5, the least one, the largest one, NaN; against 0 the error is the value.
    const std::array<std::uint16_t, 5> halves{0x3c00, 0xb800, 0x0001, 0x7bff, 0x7e00};
    const std::array<double, 5> values{1, 0.5, 0x1p-24, 65504, kInfinity};
    for (std::size_t i = 0; i < halves.size(); ++i) {
        const std::uint16_t one[]{halves[i]}, zero[]{0};
        EXPECT_EQ(compare_arrays(array(NpyType::kF2, 1, one), array(NpyType::kF2, 1, zero)).max_error, values[i]);
        EXPECT_EQ(compare_arrays(array(NpyType::kF2, 1, one), array(NpyType::kF2, 1, one)).max_error, 0);
    }
    EXPECT_THROW(compare_arrays(array(NpyType::kF4, 4, a), array(NpyType::kF4, 2, a)), Error);
    EXPECT_THROW(compare_arrays(array(NpyType::kF4, 2, a), array(NpyType::kF4, 2, b), -1), Error);
}

}  // namespace
}  // namespace tessera
