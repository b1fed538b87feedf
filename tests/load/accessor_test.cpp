// Accessors against values worked out by hand from glTF 2.0, section 3.6.2: every component type and
// shape arrives as a custom attribute of a point cloud.
#include "gltf_text.h"

#include <limits>

namespace tessera {
namespace {

using Bytes8 = std::vector<std::uint8_t>;

// One buffer view over all of `buffer` (with `view_extra` members) and one accessor (`accessor` members
// after "bufferView") as attribute _X of `count` points.
std::string with_accessor(const Bytes8& buffer, std::size_t count, const std::string& accessor,
                          const std::string& view_extra = {}, bool has_view = true) {
    std::string members = "\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{\"POSITION\":0,\"_X\":1}}]}],";
    members += "\"accessors\":[{\"componentType\":5126,\"type\":\"VEC3\",\"count\":" + std::to_string(count) + "},{";
    members += std::string(has_view ? "\"bufferView\":0," : "") + "\"count\":" + std::to_string(count) + "," + accessor;
    members += "}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":" + std::to_string(buffer.size()) + view_extra + "}]";
    return gltf_text(members, buffer);
}

std::vector<float> read(const std::string& text) { return load_text(text).meshes[0].primitives[0].custom.at(0).values; }

using Floats = std::vector<float>;

TEST(Accessor, EveryComponentType) {
    EXPECT_EQ(read(with_accessor({0x80, 0xff, 0x00, 0x7f}, 4, R"("componentType":5120,"type":"SCALAR")")),
              (Floats{-128, -1, 0, 127}));
    EXPECT_EQ(read(with_accessor({0x80, 0xff, 0x00, 0x7f}, 4, R"("componentType":5121,"type":"SCALAR")")),
              (Floats{128, 255, 0, 127}));
    EXPECT_EQ(read(with_accessor(bytes_of<std::int16_t>({-32768, 5}), 2, R"("componentType":5122,"type":"SCALAR")")),
              (Floats{-32768, 5}));
    EXPECT_EQ(read(with_accessor(bytes_of<std::uint16_t>({65535, 5}), 1, R"("componentType":5123,"type":"VEC2")")),
              (Floats{65535, 5}));
    EXPECT_EQ(read(with_accessor(bytes_of<std::uint32_t>({1u << 31, 7}), 2, R"("componentType":5125,"type":"SCALAR")")),
              (Floats{2147483648.0f, 7}));
    EXPECT_EQ(
        read(with_accessor(bytes_of<float>({1.5f, -2.5f, 3e-40f, 3e38f}), 1, R"("componentType":5126,"type":"VEC4")")),
        (Floats{1.5f, -2.5f, 3e-40f, 3e38f}));
}

TEST(Accessor, NormalisedIntegers) {
    EXPECT_EQ(
        read(with_accessor({0x80, 0x81, 0x00, 0x7f}, 4, R"("componentType":5120,"normalized":true,"type":"SCALAR")")),
        (Floats{-1, -1, 0, 1}));
    EXPECT_EQ(read(with_accessor({0, 51, 255, 128}, 4, R"("componentType":5121,"normalized":true,"type":"SCALAR")")),
              (Floats{0, 51 / 255.0f, 1, 128 / 255.0f}));
    EXPECT_EQ(read(with_accessor(bytes_of<std::int16_t>({-32768, -32767, 16384}), 3,
                                 R"("componentType":5122,"normalized":true,"type":"SCALAR")")),
              (Floats{-1, -1, 16384 / 32767.0f}));
    EXPECT_EQ(read(with_accessor(bytes_of<std::uint16_t>({65535, 13107}), 2,
                                 R"("componentType":5123,"normalized":true,"type":"SCALAR")")),
              (Floats{1, 13107 / 65535.0f}));
}

TEST(Accessor, ColumnsOfMatricesArePadded) {
    const Bytes8 mat2{1, 2, 0, 0, 3, 4, 0, 0, 5, 6, 0, 0, 7, 8, 0, 0};
    EXPECT_EQ(read(with_accessor(mat2, 2, R"("componentType":5121,"type":"MAT2")")), (Floats{1, 2, 3, 4, 5, 6, 7, 8}));
    const Bytes8 mat3{1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0};
    EXPECT_EQ(read(with_accessor(mat3, 1, R"("componentType":5121,"type":"MAT3")")),
              (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    const std::vector<std::uint16_t> mat3_short{1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0};
    EXPECT_EQ(read(with_accessor(bytes_of(mat3_short), 1, R"("componentType":5123,"type":"MAT3")")),
              (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    const std::vector<float> mat3_float{1, 2, 3, 4, 5, 6, 7, 8, 9};
    EXPECT_EQ(read(with_accessor(bytes_of(mat3_float), 1, R"("componentType":5126,"type":"MAT3")")), mat3_float);
    // The padding after the last column may be missing.
    EXPECT_EQ(read(with_accessor({1, 2, 0, 0, 3, 4}, 1, R"("componentType":5121,"type":"MAT2")")),
              (Floats{1, 2, 3, 4}));
}

TEST(Accessor, InterleavedAndUnaligned) {
    const std::vector<float> data{1, 2, 99, 3, 4, 99, 5, 6};
    EXPECT_EQ(read(with_accessor(bytes_of(data), 3, R"("componentType":5126,"type":"VEC2")", ",\"byteStride\":12")),
              (Floats{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(read(with_accessor(bytes_of(data), 2, R"("componentType":5126,"type":"VEC2","byteOffset":4)",
                                 ",\"byteStride\":12")),
              (Floats{2, 99, 4, 99}));
    Bytes8 odd = bytes_of<float>({1.25f, 2.5f});
    odd.insert(odd.begin(), 0xee);
    EXPECT_EQ(read(with_accessor(odd, 2, R"("componentType":5126,"type":"SCALAR","byteOffset":1)")),
              (Floats{1.25f, 2.5f}));
}

// sparse: 2 of 4 replaced, indices (bytes) at 0, values (floats) at 4; the base, if any, at 12.
std::string sparse_members(const std::string& indices = {}, const std::string& count = "2") {
    return R"("componentType":5126,"type":"SCALAR","sparse":{"count":)" + count +
           R"(,"indices":{"bufferView":0,"componentType":5121)" + indices +
           R"(},"values":{"bufferView":0,"byteOffset":4}})";
}
Bytes8 sparse_bytes(std::uint8_t first, std::uint8_t second) {
    Bytes8 bytes{first, second, 0, 0};
    const Bytes8 floats = bytes_of<float>({10, 20, 1, 2, 3, 4});
    bytes.insert(bytes.end(), floats.begin(), floats.end());
    return bytes;
}

TEST(Accessor, Sparse) {
    EXPECT_EQ(read(with_accessor(sparse_bytes(1, 3), 4, sparse_members() + ",\"byteOffset\":12")),
              (Floats{1, 10, 3, 20}));
    EXPECT_EQ(read(with_accessor(sparse_bytes(0, 1), 4, sparse_members(), "", false)), (Floats{10, 20, 0, 0}));
}

TEST(Accessor, SparseIndicesAscendInRange) {
    const auto error = [](std::uint8_t a, std::uint8_t b, const std::string& count = "2") {
        return load_error(with_accessor(sparse_bytes(a, b), 4, sparse_members("", count), "", false));
    };
    EXPECT_EQ(error(0, 3), "");
    EXPECT_NE(error(3, 1).find("not above the one before"), std::string::npos);
    EXPECT_NE(error(2, 2).find("not above the one before"), std::string::npos);
    EXPECT_NE(error(1, 4).find("/accessors/1/sparse/indices: sparse index 1 is 4"), std::string::npos);
    EXPECT_NE(error(0, 1, "0"), "");
    EXPECT_NE(error(0, 1, "5"), "");
}

TEST(Accessor, RangesAreExact) {
    const Bytes8 twelve(12, 0);
    const auto error = [&](std::size_t count, const std::string& extra, const std::string& view = {}) {
        return load_error(with_accessor(twelve, count, R"("componentType":5126,"type":"SCALAR")" + extra, view));
    };
    EXPECT_EQ(error(3, ""), "");
    EXPECT_NE(error(4, ""), "");
    EXPECT_EQ(error(2, ",\"byteOffset\":4"), "");
    EXPECT_NE(error(2, ",\"byteOffset\":5"), "");
    EXPECT_EQ(error(2, "", ",\"byteStride\":8"), "");   // 8 + 4 bytes
    EXPECT_NE(error(2, "", ",\"byteStride\":12"), "");  // 12 + 4
    EXPECT_NE(error(2, "", ",\"byteStride\":2"), "");   // below the element
    EXPECT_NE(error(2, "", ",\"byteStride\":256"), "");
    EXPECT_NE(error(1, ",\"byteOffset\":18446744073709551615"), "");
    EXPECT_NE(error(1, ",\"byteOffset\":-4"), "");
    EXPECT_NE(error(1, ",\"byteOffset\":1.5"), "");
    EXPECT_EQ(error(1, ",\"byteOffset\":4.0"), "");
    EXPECT_NE(error(1, "", ",\"byteOffset\":1"), "");  // the view leaves the buffer
}

TEST(Accessor, NumbersMustBeFinite) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
        const std::string type = R"("componentType":5126,"type":"VEC2")";
        const std::string error = load_error(with_accessor(bytes_of<float>({1, 2, 3, bad, 5, 6}), 3, type));
        EXPECT_EQ(error, "test.gltf: /accessors/1: element 1 is not finite");
        EXPECT_NE(load_error(with_accessor(bytes_of<float>({1, 2, 0, 3, bad}), 2, type, ",\"byteStride\":12")), "");
    }
}

TEST(Accessor, MemoryIsLimitedBeforeItIsTaken) {
    const std::string bomb = R"("meshes":[{"primitives":[{"mode":0,"attributes":{"POSITION":0}}]}],)"
                             R"("accessors":[{"componentType":5126,"type":"VEC3","count":1000000000000}])";
    EXPECT_NE(load_error(gltf_text(bomb), {}, ErrorCode::kLimit).find("/accessors/0: 1000000000000 elements without"),
              std::string::npos);
    // Sixteen million zeros are allowed, but counted.
    const std::string zeros = R"("meshes":[{"primitives":[{"mode":0,"attributes":{"POSITION":0}}]}],)"
                              R"("accessors":[{"componentType":5126,"type":"VEC3","count":16000000}])";
    LoadOptions tight;
    tight.max_bytes = 100000000;
    EXPECT_NE(load_error(gltf_text(zeros), tight, ErrorCode::kLimit).find("/accessors/0: needs 192000000 bytes more"),
              std::string::npos);
    LoadOptions options;
    options.max_bytes = 100000;
    const std::string text = with_accessor(Bytes8(4, 0), 1, R"("componentType":5121,"type":"SCALAR")");
    EXPECT_EQ(load_error(text, options), "");
    options.max_bytes = 1000;
    EXPECT_NE(load_error(text, options, ErrorCode::kLimit), "");
}

}  // namespace
}  // namespace tessera
