#include "load/stl.h"

#include "load/mesh_scene.h"
#include "load/text.h"

#include <cstring>
#include <optional>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t kHeader = 80, kTriangle = 50;  // bytes

std::uint32_t number_at(std::span<const std::byte> file, std::size_t at) {
    std::uint32_t number;
    std::memcpy(&number, file.data() + at, sizeof number);
    return number;
}

void add_solid(LoadContext& context, Scene& scene, std::string name, std::vector<Vec3>&& positions) {
    Mesh mesh;
    mesh.name = std::move(name);
    Primitive p;
    p.material = 0;
    p.positions = std::move(positions);
    if (!p.positions.empty()) mesh.primitives.push_back(std::move(p));
    add_mesh(context, scene, std::move(mesh));
}

void read_binary(LoadContext& context, std::span<const std::byte> file, Scene& scene) {
    if (file.size() < kHeader + 4) context.fail("the file ends within its header");
    const std::uint64_t count = number_at(file, kHeader);
    if (count > (file.size() - kHeader - 4) / kTriangle)
        context.fail(std::to_string(count) + " triangles do not fit into the file", "byte 80");
    count_triangles(context, count, "byte 80");
    std::vector<Vec3> positions;
    resize(context, positions, static_cast<std::size_t>(3 * count));
    // Twelve floats: the normal, three corners; two bytes of attributes.
    for (std::size_t t = 0; t < count; ++t)
        std::memcpy(&positions[3 * t], file.data() + kHeader + 4 + kTriangle * t + 12, 3 * sizeof(Vec3));
    add_solid(context, scene, {}, std::move(positions));
}

// solid NAME { facet normal x y z  outer loop  (vertex x y z) * 3  endloop  endfacet } endsolid NAME
class AsciiReader {
  public:
    AsciiReader(LoadContext& context, std::span<const std::byte> file, Scene& scene)
        : context_(context),
          text_(std::string_view(reinterpret_cast<const char*>(file.data()), file.size())),
          scene_(scene) {}

    void read() {
        while (text_.next_line())
            for (std::string_view word = text_.word(); !word.empty(); word = text_.word()) take(word);
        if (corners_ != 0) context_.fail("the file ends within a triangle", text_.place());
        if (open_) {
            context_.warn("the last solid has no end");
            end_solid();
        }
    }

  private:
    void take(std::string_view word) {
        if (word == "solid") {
            if (corners_ != 0) context_.fail("a solid begins within a triangle", text_.place());
            if (open_) end_solid();
            name_ = text_.rest();
            open_ = true;
        } else if (word == "endsolid") {
            text_.rest();
            if (corners_ != 0) context_.fail("the solid ends within a triangle", text_.place());
            end_solid();
        } else if (word == "facet") {
            text_.rest();  // the normal
        } else if (word == "vertex") {
            add_vertex();
        } else if (word == "endloop") {
            if (corners_ != 3) context_.fail("a triangle of " + std::to_string(corners_) + " vertices", text_.place());
            corners_ = 0;
            count_triangles(context_, ++triangles_, text_.place());
        } else if (word != "outer" && word != "loop" && word != "endfacet") {
            context_.fail(quoted(word) + " is no word of STL", text_.place());
        }
    }
    void add_vertex() {
        if (!open_) context_.fail("a vertex outside a solid", text_.place());
        if (++corners_ > 3) context_.fail("a triangle of more than three vertices", text_.place());
        Vec3 p;
        for (float* number : {&p.x, &p.y, &p.z}) {
            const std::string_view word = text_.word();
            const std::optional<float> value = parse_float(word);
            if (!value) context_.fail(quoted(word) + " is no number", text_.place());
            *number = *value;
        }
        append(context_, positions_, p);
    }
    void end_solid() {
        if (!open_) context_.fail("the end of a solid that has not begun", text_.place());
        add_solid(context_, scene_, std::exchange(name_, {}), std::exchange(positions_, {}));
        open_ = false;
    }

    LoadContext& context_;
    TextCursor text_;
    Scene& scene_;
    std::string name_;
    std::vector<Vec3> positions_;
    bool open_ = false;
    int corners_ = 0;
    std::uint64_t triangles_ = 0;
};

}  // namespace

bool is_binary_stl(std::span<const std::byte> file) {
    return file.size() >= kHeader + 4 &&
           file.size() - kHeader - 4 == std::uint64_t{number_at(file, kHeader)} * kTriangle;
}

bool is_ascii_stl(std::span<const std::byte> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && text.substr(first, 5) == "solid" &&
           (first + 5 == text.size() || std::string_view(" \t\r\n").find(text[first + 5]) != std::string_view::npos);
}

Scene read_stl(LoadContext& context, std::span<const std::byte> file) {
    Scene scene;
    scene.materials.push_back(plain_material());
    if (!is_binary_stl(file) && is_ascii_stl(file))
        AsciiReader(context, file, scene).read();
    else
        read_binary(context, file, scene);
    finish_scene(context, scene);
    return scene;
}

}  // namespace tessera
