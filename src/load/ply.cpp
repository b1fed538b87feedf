#include "load/ply.h"

#include "image/color.h"
#include "load/mesh_scene.h"
#include "load/ply_header.h"
#include "load/polygon.h"
#include "load/text.h"
#include "scene/vertex_normals.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace tessera {
namespace {

// The numbers of the data, one after another. `place()` says where for errors.
class AsciiNumbers {
  public:
    AsciiNumbers(const LoadContext& context, std::string_view data, std::size_t header_lines)
        : context_(context), text_(data), lines_before_(header_lines) {
        more_ = text_.next_line();
    }
    double next(PlyType type) {
        std::string_view word = text_.word();
        while (word.empty()) {
            more_ = more_ && text_.next_line();
            if (!more_) context_.fail("the file ends before its last element", place());
            word = text_.word();
        }
        std::optional<double> number;
        if (type == PlyType::kFloat32) {
            if (const std::optional<float> rounded = parse_float(word)) number = *rounded;
        } else {
            number = parse_double(word);
        }
        if (!number) context_.fail(quoted(word) + " is no number", place());
        return *number;
    }
    std::string place() const { return "line " + std::to_string(lines_before_ + text_.line()); }

  private:
    const LoadContext& context_;
    TextCursor text_;
    std::size_t lines_before_;
    bool more_;
};

template <bool kSwapped>
class BinaryNumbers {
  public:
    BinaryNumbers(const LoadContext& context, std::string_view data, std::size_t offset)
        : context_(context), data_(data), offset_(offset) {}
    double next(PlyType type) {
        switch (type) {
            case PlyType::kInt8:
                return take<std::int8_t, std::uint8_t>();
            case PlyType::kUint8:
                return take<std::uint8_t, std::uint8_t>();
            case PlyType::kInt16:
                return take<std::int16_t, std::uint16_t>();
            case PlyType::kUint16:
                return take<std::uint16_t, std::uint16_t>();
            case PlyType::kInt32:
                return take<std::int32_t, std::uint32_t>();
            case PlyType::kUint32:
                return take<std::uint32_t, std::uint32_t>();
            case PlyType::kFloat32:
                return static_cast<double>(take<float, std::uint32_t>());
            case PlyType::kFloat64:
                break;
        }
        return take<double, std::uint64_t>();
    }
    std::string place() const { return "byte " + std::to_string(offset_ + at_); }

  private:
    template <class T, class Bits>
    T take() {
        if (data_.size() - at_ < sizeof(Bits)) context_.fail("the file ends before its last element", place());
        Bits bits;
        std::memcpy(&bits, data_.data() + at_, sizeof bits);
        at_ += sizeof bits;
        if constexpr (kSwapped && sizeof bits > 1) {
            Bits swapped = 0;
            for (std::size_t i = 0; i < sizeof bits; ++i)
                swapped = static_cast<Bits>(swapped << 8 | (bits >> 8 * i & 0xff));
            bits = swapped;
        }
        return std::bit_cast<T>(bits);
    }

    const LoadContext& context_;
    std::string_view data_;
    std::size_t offset_, at_ = 0;
};

// What of the file is used.
struct PlyMesh {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> colors;
    std::vector<Vec2> texcoords;
    // Faces and edges: the vertices of all, and how many each has; -1 ends a strip.
    std::vector<std::int64_t> corners, strip;
    std::vector<std::uint32_t> sizes;
    std::vector<std::int64_t> edges;
    std::string corners_place;
};

int find_one(const PlyElement& element, std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (const int at = element.find(name); at >= 0) return at;
    return -1;
}

// A property's place among the floats of the mesh: value i goes to first[stride * i]. 8- and 16-bit
// integers of colours become 0 .. 1.
struct Column {
    float* first = nullptr;
    std::size_t stride = 0;
    double scale = 1;
};

class PlyReader {
  public:
    PlyReader(LoadContext& context, const PlyHeader& header) : context_(context), header_(header) {}

    template <class Numbers>
    PlyMesh read(Numbers numbers) {
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex")
                read_vertices(numbers, element);
            else if (element.name == "face" || element.name == "tristrips" || element.name == "edge")
                read_lists(numbers, element);
            else
                skip(numbers, element);
        }
        return std::move(mesh_);
    }

  private:
    template <class Numbers>
    std::uint64_t length(Numbers& numbers, const PlyProperty& list) {
        const double n = numbers.next(list.length_type);
        if (!(n >= 0 && n <= 4294967295.0) || n != std::floor(n))
            context_.fail("the length of a list is no length", numbers.place());
        return static_cast<std::uint64_t>(n);
    }
    template <class Numbers>
    void skip_property(Numbers& numbers, const PlyProperty& property) {
        std::uint64_t n = property.is_list ? length(numbers, property) : 1;
        for (; n > 0; --n) numbers.next(property.type);
    }
    template <class Numbers>
    void skip(Numbers& numbers, const PlyElement& element) {
        if (element.properties.empty()) return;
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) skip_property(numbers, property);
    }

    // The columns of some properties, if all of them are there; else none is read.
    template <class T>
    void add_columns(const PlyElement& element, std::vector<Column>& columns, std::vector<T>& values,
                     std::initializer_list<int> properties, bool are_colors = false) {
        for (const int p : properties)
            if (p < 0 || element.properties[static_cast<std::size_t>(p)].is_list) return;
        if (values.empty()) resize(context_, values, static_cast<std::size_t>(element.count));
        std::size_t component = 0;
        for (const int p : properties) {
            const PlyType type = element.properties[static_cast<std::size_t>(p)].type;
            Column& column = columns[static_cast<std::size_t>(p)];
            column = {reinterpret_cast<float*>(values.data()) + component++, sizeof(T) / sizeof(float), 1};
            if (are_colors && is_integer(type)) column.scale = 1.0 / (size_of(type) == 1 ? 255 : 65535);
        }
    }

    template <class Numbers>
    void read_vertices(Numbers& numbers, const PlyElement& e) {
        if (!mesh_.positions.empty()) context_.fail("two elements \"vertex\"");
        if (e.count == 0) return skip(numbers, e);
        std::vector<Column> columns(e.properties.size());
        add_columns(e, columns, mesh_.positions, {e.find("x"), e.find("y"), e.find("z")});
        if (mesh_.positions.empty()) context_.fail("the vertices have no x, y and z");
        add_columns(e, columns, mesh_.normals, {e.find("nx"), e.find("ny"), e.find("nz")});
        const int red = find_one(e, {"red", "diffuse_red", "r"}), green = find_one(e, {"green", "diffuse_green", "g"}),
                  blue = find_one(e, {"blue", "diffuse_blue", "b"}),
                  alpha = find_one(e, {"alpha", "diffuse_alpha", "a"});
        const bool has_color = red >= 0 && green >= 0 && blue >= 0;
        if (has_color && alpha >= 0) {
            add_columns(e, columns, mesh_.colors, {red, green, blue, alpha}, true);
        } else if (has_color) {
            add_columns(e, columns, mesh_.colors, {red, green, blue}, true);
            for (Vec4& color : mesh_.colors) color.w = 1;
        }
        add_columns(
            e, columns, mesh_.texcoords,
            {find_one(e, {"u", "s", "texture_u", "texture_s"}), find_one(e, {"v", "t", "texture_v", "texture_t"})});
        for (std::uint64_t i = 0; i < e.count; ++i)
            for (std::size_t p = 0; p < columns.size(); ++p) {
                const Column& column = columns[p];
                if (!column.first)
                    skip_property(numbers, e.properties[p]);
                else
                    column.first[column.stride * i] =
                        static_cast<float>(numbers.next(e.properties[p].type) * column.scale);
            }
        if (has_color && is_integer(e.properties[static_cast<std::size_t>(red)].type))
            for (Vec4& c : mesh_.colors)
                for (float* v : {&c.x, &c.y, &c.z}) *v = static_cast<float>(linear_from_srgb(static_cast<double>(*v)));
        for (Vec2& uv : mesh_.texcoords) uv.y = 1 - uv.y;  // PLY counts from the bottom
    }

    template <class Numbers>
    void read_lists(Numbers& numbers, const PlyElement& e) {
        const bool edges = e.name == "edge", strips = e.name == "tristrips";
        const int list = edges ? -1 : find_one(e, {"vertex_indices", "vertex_index"});
        const int first = edges ? e.find("vertex1") : -1, second = edges ? e.find("vertex2") : -1;
        if (list < 0 && (first < 0 || second < 0)) {
            context_.warn("the elements " + quoted(e.name) + " name no vertices; ignored");
            return skip(numbers, e);
        }
        if (list >= 0 && !e.properties[static_cast<std::size_t>(list)].is_list)
            context_.fail("the vertices of " + quoted(e.name) + " are no list");
        for (std::uint64_t i = 0; i < e.count; ++i)
            for (std::size_t p = 0; p < e.properties.size(); ++p) {
                const PlyProperty& property = e.properties[p];
                const int at = static_cast<int>(p);
                if (at == list) {
                    const std::uint64_t n = length(numbers, property);
                    for (std::uint64_t k = 0; k < n; ++k)
                        append(context_, strips ? mesh_.strip : mesh_.corners, vertex(numbers, property.type));
                    if (!strips) append(context_, mesh_.sizes, static_cast<std::uint32_t>(n));
                } else if ((at == first || at == second) && !property.is_list) {
                    append(context_, mesh_.edges, vertex(numbers, property.type));
                } else {
                    skip_property(numbers, property);
                }
            }
    }
    template <class Numbers>
    std::int64_t vertex(Numbers& numbers, PlyType type) {
        const double number = numbers.next(type);
        if (!(number >= -1 && number <= 4294967294.0) || number != std::floor(number))
            context_.fail("a vertex number that is none", numbers.place());
        return static_cast<std::int64_t>(number);
    }

    LoadContext& context_;
    const PlyHeader& header_;
    PlyMesh mesh_;
};

PlyMesh read_data(LoadContext& context, const PlyHeader& header, std::string_view data) {
    PlyReader reader(context, header);
    static_assert(std::endian::native == std::endian::little);
    switch (header.encoding) {
        case PlyEncoding::kAscii:
            return reader.read(AsciiNumbers(context, data, header.lines));
        case PlyEncoding::kLittleEndian:
            return reader.read(BinaryNumbers<false>(context, data, header.size));
        case PlyEncoding::kBigEndian:
            break;
    }
    return reader.read(BinaryNumbers<true>(context, data, header.size));
}

std::uint32_t checked_vertex(const LoadContext& context, std::int64_t number, const PlyMesh& mesh,
                             const std::string& of) {
    if (number < 0 || static_cast<std::uint64_t>(number) >= mesh.positions.size())
        context.fail("vertex " + std::to_string(number) + " of " + std::to_string(mesh.positions.size()), of);
    return static_cast<std::uint32_t>(number);
}

// The triangles of faces and strips.
std::vector<std::uint32_t> triangles_of(LoadContext& context, const PlyMesh& mesh) {
    std::vector<std::uint32_t> triangles, face, split;
    std::vector<Vec3> polygon;
    std::size_t first = 0, largest = 0;
    for (std::size_t f = 0; f < mesh.sizes.size(); ++f) {
        const std::string place = "face " + std::to_string(f);
        const std::size_t n = mesh.sizes[f];
        if (n > 3) {
            count_triangles(context, triangles.size() / 3 + n - 2, place);
            charge_polygon(context, n, largest);
        }
        face.clear(), polygon.clear(), split.clear();
        for (std::size_t k = 0; k < n; ++k) {
            face.push_back(checked_vertex(context, mesh.corners[first + k], mesh, place));
            if (n > 3) polygon.push_back(mesh.positions[face.back()]);
        }
        first += n;
        if (n == 3)
            split = {0, 1, 2};
        else
            triangulate_polygon(polygon, split);
        for (const std::uint32_t corner : split) append(context, triangles, face[corner]);
        count_triangles(context, triangles.size() / 3, place);
    }
    // Strips, which -1 parts: every second triangle is turned over.
    std::size_t begin = 0;
    for (std::size_t i = 0; i < mesh.strip.size(); ++i) {
        if (mesh.strip[i] < 0) {
            begin = i + 1;
            continue;
        }
        const std::uint32_t c = checked_vertex(context, mesh.strip[i], mesh, "tristrips");
        if (i < begin + 2) continue;
        const auto a = static_cast<std::uint32_t>(mesh.strip[i - 2]), b = static_cast<std::uint32_t>(mesh.strip[i - 1]);
        const bool turned = (i - begin) % 2 != 0;
        for (const std::uint32_t corner : {turned ? b : a, turned ? a : b, c}) append(context, triangles, corner);
        count_triangles(context, triangles.size() / 3, "tristrips");
    }
    return triangles;
}

template <class T>
void gather(LoadContext& context, std::vector<T>& values, const std::vector<std::uint32_t>& from) {
    if (values.empty()) return;
    std::vector<T> gathered;
    resize(context, gathered, from.size());
    for (std::size_t i = 0; i < from.size(); ++i) gathered[i] = values[from[i]];
    values = std::move(gathered);
}

// Smooth normals but for sharp edges, where vertices become several.
void make_normals(LoadContext& context, PlyMesh& mesh, std::vector<std::uint32_t>& triangles) {
    context.charge(std::uint64_t{triangles.size()} * (2 * sizeof(std::uint32_t) + sizeof(Vec3)));
    std::size_t count = 0;
    std::vector<std::uint32_t> groups = crease_groups(mesh.positions, triangles, count);
    context.charge(std::uint64_t{count} * (sizeof(Vec3) + 3 * sizeof(double)));
    mesh.normals = angle_weighted_normals(mesh.positions, triangles, groups, count);
    std::vector<std::uint32_t> from(count);
    for (std::size_t i = 0; i < triangles.size(); ++i) from[groups[i]] = triangles[i];
    gather(context, mesh.positions, from);
    gather(context, mesh.colors, from);
    gather(context, mesh.texcoords, from);
    triangles = std::move(groups);
}

void turn_triangles(const PlyMesh& mesh, std::vector<std::uint32_t>& triangles) {
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        std::uint32_t* const t = &triangles[i];
        if (is_turned({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]},
                      {mesh.normals[t[0]], mesh.normals[t[1]], mesh.normals[t[2]]}))
            std::swap(t[1], t[2]);
    }
}

}  // namespace

bool is_ply(std::span<const std::byte> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    return text.starts_with("ply\n") || text.starts_with("ply\r");
}

Scene read_ply(LoadContext& context, std::span<const std::byte> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    const PlyHeader header = read_ply_header(context, text);
    PlyMesh mesh = read_data(context, header, text.substr(header.size));

    Scene scene;
    Primitive p;
    p.material = 0;
    p.indices = triangles_of(context, mesh);
    if (p.indices.empty()) {
        p.mode = mesh.edges.empty() ? PrimitiveMode::kPoints : PrimitiveMode::kLines;
        for (const std::int64_t end : mesh.edges)
            append(context, p.indices, checked_vertex(context, end, mesh, "edges"));
    }
    for (Vec3& n : mesh.normals) n = unit_normal(n);
    if (p.mode == PrimitiveMode::kTriangles) {
        if (mesh.normals.empty())
            make_normals(context, mesh, p.indices);
        else
            turn_triangles(mesh, p.indices);
    }
    p.positions = std::move(mesh.positions);
    p.normals = std::move(mesh.normals);
    if (!mesh.colors.empty()) p.colors.push_back(std::move(mesh.colors));
    if (!mesh.texcoords.empty()) p.texcoords.push_back(std::move(mesh.texcoords));
    scene.materials.push_back(plain_material());
    if (!p.colors.empty()) scene.materials[0].base_color = {1, 1, 1, 1};
    Mesh whole;
    if (!p.positions.empty()) whole.primitives.push_back(std::move(p));
    add_mesh(context, scene, std::move(whole));
    finish_scene(context, scene);
    return scene;
}

}  // namespace tessera
