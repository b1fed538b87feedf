#include "load/ply_header.h"

#include "load/text.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t kMaxElements = 256, kMaxProperties = 1024, kMaxTextures = 1024;

std::optional<PlyType> type_named(std::string_view name) {
    using enum PlyType;
    static constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames{{{"char", kInt8},
                                                                                  {"int8", kInt8},
                                                                                  {"uchar", kUint8},
                                                                                  {"uint8", kUint8},
                                                                                  {"short", kInt16},
                                                                                  {"int16", kInt16},
                                                                                  {"ushort", kUint16},
                                                                                  {"uint16", kUint16},
                                                                                  {"int", kInt32},
                                                                                  {"int32", kInt32},
                                                                                  {"uint", kUint32},
                                                                                  {"uint32", kUint32},
                                                                                  {"float", kFloat32},
                                                                                  {"float32", kFloat32},
                                                                                  {"double", kFloat64},
                                                                                  {"float64", kFloat64}}};
    for (const auto& [known, type] : kNames)
        if (known == name) return type;
    return std::nullopt;
}

PlyType read_type(const LoadContext& context, TextCursor& text) {
    const std::string_view name = text.word();
    const std::optional<PlyType> type = type_named(name);
    if (!type) context.fail(quoted(name) + " is no type of PLY", text.place());
    return *type;
}

PlyProperty read_property(const LoadContext& context, TextCursor& text) {
    PlyProperty property{};
    TextCursor ahead = text;
    if (ahead.word() == "list") {
        text.word();
        property.is_list = true;
        property.length_type = read_type(context, text);
        if (!is_integer(property.length_type)) context.fail("the length of a list must be an integer", text.place());
    }
    property.type = read_type(context, text);
    property.name = text.word();
    if (property.name.empty()) context.fail("a property without a name", text.place());
    return property;
}

PlyEncoding read_format(const LoadContext& context, TextCursor& text) {
    const std::string_view name = text.word(), version = text.word();
    if (version != "1.0") context.fail("version " + quoted(version) + " of PLY is not known", text.place());
    if (name == "ascii") return PlyEncoding::kAscii;
    if (name == "binary_little_endian") return PlyEncoding::kLittleEndian;
    if (name == "binary_big_endian") return PlyEncoding::kBigEndian;
    context.fail(quoted(name) + " is no format of PLY", text.place());
}

// By habit, not by the format: what texture numbers count.
void add_texture(LoadContext& context, TextCursor& text, PlyHeader& header) {
    if (header.texture_files.size() == kMaxTextures) context.fail("more than 1024 textures", text.place());
    std::string name(text.rest().substr(0, 4096));
    std::replace(name.begin(), name.end(), '\\', '/');
    if (!name.empty()) header.texture_files.push_back(std::move(name));
}

// Before anything is allocated: even the shortest elements must fit into the rest of the file.
void check_room(const LoadContext& context, const PlyHeader& header, std::uint64_t rest) {
    for (const PlyElement& e : header.elements) {
        const std::uint64_t least = std::max<std::uint64_t>(e.least_bytes(header.encoding), 1);
        // The last number of a text needs nothing behind it.
        if (e.count > (rest + 1) / least)
            context.fail(std::to_string(e.count) + " elements " + quoted(e.name) + " do not fit into the file");
        rest -= std::min(rest, e.count * least);
    }
}

}  // namespace

std::size_t size_of(PlyType type) {
    switch (type) {
        case PlyType::kInt8:
        case PlyType::kUint8:
            return 1;
        case PlyType::kInt16:
        case PlyType::kUint16:
            return 2;
        case PlyType::kFloat64:
            return 8;
        default:
            return 4;
    }
}

int PlyElement::find(std::string_view property) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].name == property) return static_cast<int>(i);
    return -1;
}

std::uint64_t PlyElement::least_bytes(PlyEncoding encoding) const {
    if (encoding == PlyEncoding::kAscii) return 2 * properties.size();  // a digit and what parts it
    std::uint64_t bytes = 0;
    for (const PlyProperty& p : properties) bytes += size_of(p.is_list ? p.length_type : p.type);
    return bytes;
}

PlyHeader read_ply_header(LoadContext& context, std::string_view file) {
    PlyHeader header{};
    TextCursor text(file);
    text.next_line();
    bool has_format = false;
    while (text.next_line()) {
        const std::string_view keyword = text.word();
        if (keyword == "format") {
            header.encoding = read_format(context, text);
            has_format = true;
        } else if (keyword == "element") {
            if (header.elements.size() == kMaxElements) context.fail("more than 256 elements", text.place());
            PlyElement element;
            element.name = text.word();
            const std::optional<long long> count = parse_integer(text.word());
            if (!count || *count < 0) context.fail("the count of an element is missing", text.place());
            element.count = static_cast<std::uint64_t>(*count);
            header.elements.push_back(std::move(element));
        } else if (keyword == "property") {
            if (header.elements.empty()) context.fail("a property without an element", text.place());
            std::vector<PlyProperty>& properties = header.elements.back().properties;
            if (properties.size() == kMaxProperties) context.fail("more than 1024 properties", text.place());
            properties.push_back(read_property(context, text));
        } else if (keyword == "end_header") {
            if (!has_format) context.fail("the header names no format", text.place());
            header.size = text.offset_after_line();
            header.lines = text.line();
            check_room(context, header, file.size() - header.size);
            return header;
        } else if (keyword == "comment") {
            if (text.word() == "TextureFile") add_texture(context, text, header);
        } else if (keyword != "obj_info" && !keyword.empty()) {
            context.warn(text.place() + ": " + quoted(keyword) + " is no line of a PLY header; ignored");
        }
    }
    context.fail("the header has no end", text.place());
}

}  // namespace tessera
