#include "load/stl.h"

#include "load/mesh_scene.h"
#include "load/text.h"

#include <algorithm>
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

// The count of the header, or what the size of the file says where a writer never filled it in.
std::uint64_t binary_count(LoadContext& context, std::span<const std::byte> file) {
    const std::uint64_t count = number_at(file, kHeader), behind = file.size() - kHeader - 4,
                        records = behind / kTriangle;
    if (count > records) context.fail(std::to_string(count) + " triangles do not fit into the file", "byte 80");
    if (count == 0 && records > 0 && behind % kTriangle == 0) {
        context.warn("byte 80: the header counts no triangles; the " + std::to_string(records) +
                     " that follow it are read");
        return records;
    }
    if (behind != count * kTriangle)
        context.warn("byte 80: " + std::to_string(behind - count * kTriangle) + " bytes behind the " +
                     std::to_string(count) + " triangles that the header counts are not read");
    return count;
}

void read_binary(LoadContext& context, std::span<const std::byte> file, Scene& scene) {
    if (file.size() < kHeader + 4) context.fail("the file ends within its header");
    const std::uint64_t count = binary_count(context, file);
    count_triangles(context, count, "byte 80");
    std::vector<Vec3> positions;
    resize(context, positions, static_cast<std::size_t>(3 * count));
    // Twelve floats: the normal, three corners; two bytes of attributes.
    for (std::size_t t = 0; t < count; ++t)
        std::memcpy(&positions[3 * t], file.data() + kHeader + 4 + kTriangle * t + 12, 3 * sizeof(Vec3));
    add_solid(context, scene, {}, std::move(positions));
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// The words of STL are told apart without regard to case; `keyword` is in lower case.
bool is(std::string_view word, std::string_view keyword) {
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                      [](char a, char b) { return lower(a) == b; });
}

// Not of the format, but written by some.
bool is_comment(std::string_view word) {
    return word.starts_with('#') || word.starts_with(';') || word.starts_with("//");
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
        if (triangles_ == 0) context_.fail("the file holds no facet");
    }

  private:
    void take(std::string_view word) {
        if (is(word, "vertex")) {
            add_vertex();
        } else if (is(word, "facet")) {
            pass_to("outer");  // the normal
        } else if (is(word, "endloop")) {
            if (corners_ != 3) context_.fail("a triangle of " + std::to_string(corners_) + " vertices", text_.place());
            corners_ = 0;
            count_triangles(context_, ++triangles_, text_.place());
        } else if (is(word, "solid")) {
            if (corners_ != 0) context_.fail("a solid begins within a triangle", text_.place());
            if (open_) end_solid();
            name_ = pass_to("facet");
            open_ = true;
        } else if (is(word, "endsolid")) {
            pass_to("solid");
            if (corners_ != 0) context_.fail("the solid ends within a triangle", text_.place());
            end_solid();
        } else if (is_comment(word)) {
            text_.rest();
        } else if (!is(word, "outer") && !is(word, "loop") && !is(word, "endfacet")) {
            context_.fail(quoted(word) + " is no word of STL", text_.place());
        }
    }
    // The text up to `keyword`, or to the end of the line. A file may be all on one line, and the words of a name may
    // be keywords: "solid" goes on with a solid only where a facet follows.
    std::string pass_to(std::string_view keyword) {
        constexpr int kMostWords = 64;  // of a name
        TextCursor ahead = text_, before = text_;
        std::string passed;
        for (int i = 0; i < kMostWords; ++i, before = ahead) {
            const std::string_view word = ahead.word();
            if (word.empty()) break;
            if (is(word, keyword) && (keyword != "solid" || is_on_line(ahead, "facet"))) {
                text_ = before;
                return passed;
            }
            if (keyword == "facet") passed.append(passed.empty() ? "" : " ").append(word);
        }
        return std::string(text_.rest());
    }
    static bool is_on_line(TextCursor ahead, std::string_view keyword) {
        constexpr int kMostWords = 64;
        for (int i = 0; i < kMostWords; ++i)
            if (is(ahead.word(), keyword)) return true;
        return false;
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
    // The header of a binary file may begin with "solid" too, but its numbers have bytes that no text has.
    constexpr std::size_t kLooked = 4096;
    for (const char c : text.substr(0, kLooked)) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 9 || (code > 13 && code < 32)) return false;
    }
    TextCursor cursor(text);
    while (cursor.next_line()) {
        const std::string_view word = cursor.word();
        if (word.empty()) continue;
        if (!is_comment(word)) return is(word, "solid");
        cursor.rest();
    }
    return false;
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
