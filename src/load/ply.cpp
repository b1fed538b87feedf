#include "load/ply.h"

#include "image/color.h"
#include "load/mesh_scene.h"
#include "load/pictures.h"
#include "load/ply_header.h"
#include "load/ply_mesh.h"
#include "load/text.h"

#include <algorithm>
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

int find_one(const PlyElement& element, std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (const int at = element.find(name); at >= 0) return at;
    return -1;
}

// A property's place among the floats of the mesh: value i goes to first[stride * i]. Integers of colours become
// 0 .. 1: of 16 bits they count to 65535, else to 255.
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
        if (!mesh_.wedges.empty()) pad_wedges();
        return std::move(mesh_);
    }

  private:
    // Corners of faces that have none.
    void pad_wedges() {
        while (mesh_.wedges.size() < mesh_.corners.size()) append(context_, mesh_.wedges, PlyWedge{});
    }

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
            if (are_colors && is_integer(type)) column.scale = 1.0 / (size_of(type) == 2 ? 65535 : 255);
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
        check_colors();
        if (has_color && is_integer(e.properties[static_cast<std::size_t>(red)].type))
            for (Vec4& c : mesh_.colors)
                for (float* v : {&c.x, &c.y, &c.z}) *v = static_cast<float>(linear_from_srgb(static_cast<double>(*v)));
        for (Vec2& uv : mesh_.texcoords) uv.y = 1 - uv.y;  // PLY counts from the bottom
    }

    // Writers of floats may mean 255 as white, and some fill alpha with zeros.
    void check_colors() {
        constexpr float kFarAboveWhite = 8;
        float most = 0, most_alpha = 0;
        for (const Vec4& c : mesh_.colors) {
            most = std::max({most, c.x, c.y, c.z});
            most_alpha = std::max(most_alpha, c.w);
        }
        if (most > kFarAboveWhite)
            context_.warn("the colours of the vertices are far above 1, which is white; 255 is where they are uchar");
        if (mesh_.colors.empty() || most_alpha > 0) return;
        context_.warn("every vertex has an alpha of 0; it is taken as 1");
        for (Vec4& c : mesh_.colors) c.w = 1;
    }

    template <class Numbers>
    void read_lists(Numbers& numbers, const PlyElement& e) {
        const bool edges = e.name == "edge", strips = e.name == "tristrips";
        const bool faces = !edges && !strips;
        const int list = edges ? -1 : find_one(e, {"vertex_indices", "vertex_index"});
        const int wedges = faces ? list_named(e, "texcoord") : -1;
        const int texture = faces && wedges >= 0 ? e.find("texnumber") : -1;
        const int first = edges ? e.find("vertex1") : -1, second = edges ? e.find("vertex2") : -1;
        if (list < 0 && (first < 0 || second < 0)) {
            context_.warn("the elements " + quoted(e.name) + " name no vertices; ignored");
            return skip(numbers, e);
        }
        if (list >= 0 && !e.properties[static_cast<std::size_t>(list)].is_list)
            context_.fail("the vertices of " + quoted(e.name) + " are no list");
        if (wedges >= 0) pad_wedges();
        for (std::uint64_t i = 0; i < e.count; ++i) {
            const std::size_t first_wedge = mesh_.wedges.size();
            std::uint64_t corners = 0;
            double number = 0;  // of the texture
            for (std::size_t p = 0; p < e.properties.size(); ++p) {
                const PlyProperty& property = e.properties[p];
                const int at = static_cast<int>(p);
                if (at == list) {
                    corners = length(numbers, property);
                    for (std::uint64_t k = 0; k < corners; ++k)
                        append(context_, strips ? mesh_.strip : mesh_.corners, vertex(numbers, property.type));
                    if (!strips) append(context_, mesh_.sizes, static_cast<std::uint32_t>(corners));
                } else if (at == wedges) {
                    read_wedges(numbers, property);
                } else if (at == texture && !property.is_list) {
                    number = numbers.next(property.type);
                } else if ((at == first || at == second) && !property.is_list) {
                    append(context_, mesh_.edges, vertex(numbers, property.type));
                } else {
                    skip_property(numbers, property);
                }
            }
            if (wedges >= 0) finish_wedges(first_wedge, corners, number);
        }
    }
    static int list_named(const PlyElement& e, std::string_view name) {
        const int at = e.find(name);
        return at >= 0 && e.properties[static_cast<std::size_t>(at)].is_list ? at : -1;
    }
    // u and v of each corner of a face.
    template <class Numbers>
    void read_wedges(Numbers& numbers, const PlyProperty& property) {
        const std::uint64_t n = length(numbers, property);
        for (std::uint64_t k = 0; k < n; ++k) {
            const auto value = static_cast<float>(numbers.next(property.type));
            if (k % 2 == 0)
                append(context_, mesh_.wedges, PlyWedge{{value, 0}, 0});
            else
                mesh_.wedges.back().uv.y = 1 - value;  // PLY counts from the bottom
        }
        odd_ = n % 2 != 0;
    }
    void finish_wedges(std::size_t first, std::uint64_t corners, double texture) {
        if (odd_ || mesh_.wedges.size() - first != corners) {
            if (!warned_)
                context_.warn("a face whose texture coordinates are not two for each corner; they are left out");
            warned_ = true;
            mesh_.wedges.resize(first);
            for (std::uint64_t k = 0; k < corners; ++k) append(context_, mesh_.wedges, PlyWedge{});
        }
        odd_ = false;
        constexpr double kMost = 1e6;
        const int number = texture >= 0 && texture <= kMost ? static_cast<int>(texture) : kNone;
        for (std::size_t k = first; k < mesh_.wedges.size(); ++k) mesh_.wedges[k].texture = number;
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
    bool odd_ = false, warned_ = false;  // texture coordinates of a face
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

// Grey, or white under the picture that a file of this name holds.
Material material_of(LoadContext& context, Scene& scene, const SceneFiles& files, const std::string& name,
                     std::vector<PictureFile>& pictures) {
    Material material = plain_material();
    const std::string place = "TextureFile " + quoted(name);
    try {
        PictureFile file{scene.pictures.size(), place, {}, {}, {}};
        if (context.options().load_pictures) file.owned = read_beside(context, files, name, place);
        file.bytes = file.owned.span();
        context.charge(sizeof(Picture) + sizeof(Texture) + name.size());
        Picture picture;
        picture.uri = name;
        Texture texture;
        texture.picture = static_cast<int>(scene.pictures.size());
        scene.pictures.push_back(std::move(picture));
        if (context.options().load_pictures) pictures.push_back(std::move(file));
        material.base_color = {1, 1, 1, 1};
        material.texture(TextureSlot::kBaseColor).texture = static_cast<int>(scene.textures.size());
        scene.textures.push_back(std::move(texture));
    } catch (const Error& error) {
        if (error.code() != ErrorCode::kInput) throw;
        context.warn(place + ": " + error.message());
    }
    return material;
}

// The parts of the mesh with a material for each texture that they name.
void add_parts(LoadContext& context, Scene& scene, const SceneFiles& files, const PlyHeader& header,
               std::vector<PlyPart>&& parts) {
    Mesh whole;
    std::vector<PictureFile> pictures;
    for (PlyPart& part : parts) {
        Primitive& p = part.primitive;
        p.material = static_cast<int>(scene.materials.size());
        context.charge(sizeof(Material) + sizeof(Primitive));
        const bool textured = part.texture != kNone && !p.texcoords.empty();
        scene.materials.push_back(textured ? material_of(context, scene, files,
                                                         header.texture_files[static_cast<std::size_t>(part.texture)],
                                                         pictures)
                                           : plain_material());
        if (!p.colors.empty()) {
            scene.materials.back().base_color = {1, 1, 1, 1};
            if (std::any_of(p.colors[0].begin(), p.colors[0].end(), [](const Vec4& c) { return c.w < 1; }))
                scene.materials.back().alpha_mode = AlphaMode::kBlend;
        }
        // Bare points and lines take the ink that is seen on any background.
        if (p.mode != PrimitiveMode::kTriangles && p.colors.empty() && p.normals.empty() && !textured)
            p.material = kNone;
        whole.primitives.push_back(std::move(p));
    }
    if (whole.primitives.empty()) scene.materials.push_back(plain_material());
    decode_pictures(context, std::move(pictures), scene, PictureFaults::kWarn);
    add_mesh(context, scene, std::move(whole));
}

}  // namespace

bool is_ply(std::span<const std::byte> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    return text.starts_with("ply\n") || text.starts_with("ply\r");
}

Scene read_ply(LoadContext& context, std::span<const std::byte> file, const SceneFiles& files) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    const PlyHeader header = read_ply_header(context, text);
    PlyMesh mesh = read_data(context, header, text.substr(header.size));
    PlyTriangles triangles = triangulate(context, mesh);
    for (Vec3& n : mesh.normals) n = unit_normal(n);
    Scene scene;
    std::vector<PlyPart> parts;
    if (triangles.vertices.empty()) {
        parts = lines_or_points(context, std::move(mesh));
    } else {
        if (!mesh.edges.empty())
            context.warn("edges beside the faces are not drawn; there are " + std::to_string(mesh.edges.size() / 2));
        if (mesh.normals.empty())
            make_normals(context, mesh, triangles);
        else
            turn_to_normals(mesh, triangles);
        parts = split_by_texture(context, std::move(mesh), std::move(triangles),
                                 static_cast<int>(header.texture_files.size()));
    }
    add_parts(context, scene, files, header, std::move(parts));
    finish_scene(context, scene);
    return scene;
}

}  // namespace tessera
