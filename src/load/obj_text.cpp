#include "load/obj_text.h"

#include "image/color.h"
#include "load/mesh_scene.h"
#include "load/text.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

namespace tessera {
namespace {

// Statements that are read, and those that say nothing about polygons.
constexpr std::string_view kKnown[] = {"v", "vt", "vn", "f", "fo", "l", "p", "o", "g", "s", "usemtl", "mtllib"};
constexpr std::string_view kIgnored[] = {"mg",         "lod",       "bevel",  "c_interp", "d_interp",
                                         "shadow_obj", "trace_obj", "usemap", "maplib",   "ctech",
                                         "stech",      "deg",       "bmat",   "step",     "vp"};
constexpr std::string_view kFreeForm[] = {"cstype", "curv", "curv2", "surf", "parm", "trim",
                                          "hole",   "scrv", "sp",    "end",  "con"};

template <std::size_t kCount>
bool is_one_of(const std::string_view (&words)[kCount], std::string_view word) {
    return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

class ObjReader {
  public:
    ObjReader(LoadContext& context, std::string_view text) : context_(context), text_(text, true) {}

    ObjText read() {
        out_.objects.emplace_back();
        while (text_.next_line()) {
            const std::string_view keyword = text_.word();
            if (keyword.empty() || keyword.front() == '#')
                text_.rest();  // a backslash at the end of a comment joins nothing
            else
                statement(keyword);
        }
        finish_smoothing();
        if (!out_.colors.empty()) out_.colors.resize(out_.positions.size(), Vec4{1, 1, 1, 1});
        return std::move(out_);
    }

  private:
    void statement(std::string_view keyword) {
        if (keyword == "v") return position();
        if (keyword == "vt") return append(context_, out_.texcoords, texcoord());
        if (keyword == "vn") return append(context_, out_.normals, Vec3{number(), number(), number()});
        if (keyword == "f" || keyword == "fo") return element(PrimitiveMode::kTriangles, 3);
        if (keyword == "l") return element(PrimitiveMode::kLines, 2);
        if (keyword == "p") return element(PrimitiveMode::kPoints, 1);
        if (keyword == "o") return begin_object(true);
        if (keyword == "g") return begin_object(false);
        if (keyword == "s") return smoothing();
        if (keyword == "usemtl") return use_material();
        if (keyword == "mtllib") return library();
        if (is_one_of(kFreeForm, keyword)) return warn_once("free-form curves and surfaces are not drawn");
        if (is_one_of(kIgnored, keyword)) return;
        // Words of other programs are passed over; what is no word at all is no OBJ.
        for (const char c : keyword.substr(0, 60))
            if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) context_.fail("no statement of OBJ", text_.place());
        if (++unknown_ > 64 && out_.positions.empty()) context_.fail("no OBJ file: 64 lines that are none of it");
        warn_once("the statement " + quoted(keyword) + " is not known");
    }

    float number() {
        const std::string_view word = text_.word();
        const std::optional<float> value = parse_float(word);
        if (!value) context_.fail(word.empty() ? "a number is missing" : quoted(word) + " is no number", text_.place());
        return finite(*value);
    }
    // The next number, if there is one.
    std::optional<float> further() {
        const std::string_view word = text_.word();
        if (word.empty() || word.front() == '#') return std::nullopt;
        const std::optional<float> value = parse_float(word);
        if (!value) context_.fail(quoted(word) + " is no number", text_.place());
        return finite(*value);
    }
    float finite(float value) {
        if (!(value <= std::numeric_limits<float>::max() && value >= -std::numeric_limits<float>::max()))
            context_.fail("a number that is not finite", text_.place());
        return value;
    }

    // v x y z [w], or x y z r g b: colours as sRGB codes, as the programs write them.
    void position() {
        append(context_, out_.positions, Vec3{number(), number(), number()});
        float more[3];
        int count = 0;
        for (; count < 3; ++count) {
            const std::optional<float> value = further();
            if (!value) break;
            more[count] = *value;
        }
        if (count < 3) return;
        if (out_.colors.empty()) {
            resize(context_, out_.colors, out_.positions.size() - 1);
            std::fill(out_.colors.begin(), out_.colors.end(), Vec4{1, 1, 1, 1});
        }
        while (out_.colors.size() + 1 < out_.positions.size()) append(context_, out_.colors, Vec4{1, 1, 1, 1});
        const auto linear = [](float code) {
            return static_cast<float>(linear_from_srgb(static_cast<double>(std::clamp(code, 0.0f, 1.0f))));
        };
        append(context_, out_.colors, Vec4{linear(more[0]), linear(more[1]), linear(more[2]), 1});
    }

    // vt u [v [w]], counted from the bottom.
    Vec2 texcoord() {
        const float u = number();
        const std::optional<float> v = further();
        return {u, 1 - v.value_or(0)};
    }

    // A reference from 1 on, or from -1 back; -1 where there is none.
    std::int32_t resolve(std::string_view digits, std::size_t size, const char* what) {
        if (digits.empty()) return -1;
        long long number = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        const auto count = static_cast<long long>(size);
        if (error != std::errc() || end != digits.data() + digits.size() || number == 0 || number > count ||
            number < -count)
            context_.fail(std::string(what) + " " + quoted(digits) + " of " + std::to_string(size), text_.place());
        return static_cast<std::int32_t>(number > 0 ? number - 1 : count + number);
    }

    ObjCorner corner(std::string_view word) {
        const std::size_t slash = word.find('/');
        const std::string_view position = word.substr(0, slash);
        std::string_view texcoord, normal;
        if (slash != word.npos) {
            texcoord = word.substr(slash + 1);
            const std::size_t second = texcoord.find('/');
            if (second != texcoord.npos) {
                normal = texcoord.substr(second + 1);
                texcoord = texcoord.substr(0, second);
            }
        }
        if (position.empty()) context_.fail(quoted(word) + " names no vertex", text_.place());
        return {resolve(position, out_.positions.size(), "vertex"),
                resolve(texcoord, out_.texcoords.size(), "texture coordinate"),
                resolve(normal, out_.normals.size(), "normal")};
    }

    void element(PrimitiveMode mode, std::uint32_t least) {
        ObjElement e{static_cast<std::uint32_t>(out_.corners.size()), 0, 0, smoothing_,
                     static_cast<std::uint32_t>(text_.line())};
        for (std::string_view word = text_.word(); !word.empty() && word.front() != '#'; word = text_.word()) {
            append(context_, out_.corners, corner(word));
            ++e.corner_count;
        }
        if (out_.corners.size() > std::numeric_limits<std::int32_t>::max()) context_.fail("too many corners");
        if (e.corner_count < least) return warn_once("elements of too few vertices are not drawn");
        e.part = part(mode);
        ++out_.parts[e.part].elements;
        triangles_ += e.corner_count - (mode == PrimitiveMode::kTriangles ? 2 : mode == PrimitiveMode::kLines ? 1 : 0);
        count_triangles(context_, triangles_, text_.place());
        append(context_, out_.elements, e);
    }

    // The part that elements go to now.
    std::uint32_t part(PrimitiveMode mode) {
        const ObjPart wanted{static_cast<std::uint32_t>(out_.objects.size() - 1), material_, mode};
        if (!out_.parts.empty() && out_.parts[last_part_] == wanted) return last_part_;
        const auto key = std::make_tuple(wanted.object, wanted.material, wanted.mode);
        const auto [found, is_new] = part_of_.try_emplace(key, static_cast<std::uint32_t>(out_.parts.size()));
        if (is_new) append(context_, out_.parts, wanted);
        return last_part_ = found->second;
    }

    // Groups are objects as long as the file has no objects.
    void begin_object(bool is_object) {
        if (is_object && !has_objects_) has_objects_ = true;
        if (!is_object && has_objects_) return;
        const std::string name(text_.rest().substr(0, 200));
        context_.charge(name.size() + sizeof(std::string));
        if (out_.objects.back().empty() && out_.elements.empty() && out_.objects.size() == 1)
            out_.objects.back() = name;
        else
            out_.objects.push_back(name);
    }

    void smoothing() {
        const std::string_view word = text_.word();
        has_smoothing_ = true;
        if (word == "off" || word.empty()) {
            smoothing_ = 0;
            return;
        }
        if (word == "on") {
            smoothing_ = 1;
            return;
        }
        const std::optional<long long> group = parse_integer(word);
        if (!group || *group < 0 || *group >= kUnsaid)
            context_.fail(quoted(word) + " is no smoothing group", text_.place());
        smoothing_ = static_cast<std::uint32_t>(*group);
    }
    // By definition smoothing is off until a file says otherwise; some files never do.
    void finish_smoothing() {
        for (ObjElement& e : out_.elements)
            if (e.smoothing == kUnsaid && has_smoothing_) e.smoothing = 0;
    }

    void use_material() {
        const std::string name(text_.rest().substr(0, 400));
        const auto [found, is_new] = material_of_.try_emplace(name, static_cast<std::int32_t>(out_.materials.size()));
        if (is_new) {
            context_.charge(2 * name.size() + 200);
            out_.materials.push_back(name);
        }
        material_ = found->second;
    }

    void library() {
        if (out_.libraries.size() == 64) return warn_once("more than 64 material libraries");
        out_.libraries.emplace_back(text_.rest().substr(0, 4096));
    }

    void warn_once(const std::string& what) {
        if (warned_.size() < 64 && warned_.insert(what).second) context_.warn(text_.place() + ": " + what);
    }

    LoadContext& context_;
    TextCursor text_;
    ObjText out_;
    std::int32_t material_ = -1;
    std::uint32_t smoothing_ = kUnsaid, last_part_ = 0;
    bool has_objects_ = false, has_smoothing_ = false;
    std::uint64_t triangles_ = 0, unknown_ = 0;
    std::map<std::string, std::int32_t> material_of_;
    std::map<std::tuple<std::uint32_t, std::int32_t, PrimitiveMode>, std::uint32_t> part_of_;
    std::set<std::string> warned_;
};

}  // namespace

bool looks_like_obj(std::string_view text) {
    TextCursor cursor(text.substr(0, 1 << 16));
    while (cursor.next_line()) {
        const std::string_view word = cursor.word();
        if (word.empty() || word.front() == '#') continue;
        return is_one_of(kKnown, word);
    }
    return false;
}

ObjText read_obj_text(LoadContext& context, std::string_view text) { return ObjReader(context, text).read(); }

}  // namespace tessera
