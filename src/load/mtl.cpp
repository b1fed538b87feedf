#include "load/mtl.h"

#include "load/text.h"

#include <algorithm>
#include <limits>
#include <set>

namespace tessera {
namespace {

// Statements are told apart without regard to case, as writers differ.
std::string lower(std::string_view word) {
    std::string result(word.substr(0, 32));
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

class MtlReader {
  public:
    MtlReader(LoadContext& context, std::string_view text, const std::string& file)
        : context_(context), text_(text, true), file_(file) {}

    std::vector<MtlMaterial> read() {
        while (text_.next_line()) {
            const std::string keyword = lower(text_.word());
            if (keyword.empty() || keyword.front() == '#') {
                text_.rest();  // a backslash at the end of a comment joins nothing
                continue;
            }
            if (keyword == "newmtl")
                begin();
            else if (materials_.empty())
                warn_once("statements before the first newmtl");
            else
                statement(keyword, materials_.back());
        }
        return std::move(materials_);
    }

  private:
    void begin() {
        context_.charge(sizeof(MtlMaterial) + 1024);
        materials_.emplace_back();
        materials_.back().name = text_.rest().substr(0, 400);
    }

    // One that is damaged is left out, and the others stay.
    void statement(const std::string& keyword, MtlMaterial& m) {
        try {
            if (!factor(keyword, m) && !map(keyword, m)) warn_once("the statement " + quoted(keyword) + " is not read");
        } catch (const Error& error) {
            if (error.code() != ErrorCode::kInput) throw;
            context_.warn(error.location() + ": " + error.message() + "; the statement is left out");
        }
    }

    bool factor(const std::string& keyword, MtlMaterial& m) {
        if (keyword == "ka") return color([&](Vec3 c) { m.ambient = c; });
        if (keyword == "kd") return color([&](Vec3 c) { m.diffuse = c; });
        if (keyword == "ks") return color([&](Vec3 c) { m.specular = c; });
        if (keyword == "ke") return color([&](Vec3 c) { m.emission = c; });
        if (keyword == "tf") return color([&](Vec3 c) { m.filter = c; });
        if (keyword == "ns") return number([&](float v) { m.shininess = std::max(v, 0.0f); });
        if (keyword == "ni") return number([&](float v) { m.ior = v; });
        // Writers disagree about Tr; where d is there, it counts.
        if (keyword == "tr")
            return number([&](float v) {
                if (!m.has_opacity) m.opacity = 1 - std::clamp(v, 0.0f, 1.0f);
            });
        if (keyword == "pr") return number([&](float v) { m.roughness = std::clamp(v, 0.0f, 1.0f); });
        if (keyword == "pm") return number([&](float v) { m.metallic = std::clamp(v, 0.0f, 1.0f); });
        if (keyword == "illum")
            return number([&](float v) { m.illumination = static_cast<int>(std::clamp(v, 0.0f, 10.0f)); });
        if (keyword == "d") {
            TextCursor ahead = text_;
            if (lower(ahead.word()) == "-halo") {
                text_.word();
                warn_once("halos are not drawn: d -halo is read as d");
            }
            return number([&](float v) {
                m.has_opacity = true;
                m.opacity = std::clamp(v, 0.0f, 1.0f);
            });
        }
        return keyword == "sharpness";  // of reflections, for engines that blur them
    }

    bool map(const std::string& keyword, MtlMaterial& m) {
        MtlTexture* texture = nullptr;
        if (keyword == "map_ka") texture = &m.map_ambient;
        if (keyword == "map_kd") texture = &m.map_diffuse;
        if (keyword == "map_ks") texture = &m.map_specular;
        if (keyword == "map_ke") texture = &m.map_emission;
        if (keyword == "map_ns") texture = &m.map_shininess;
        if (keyword == "map_d" || keyword == "map_tr") texture = &m.map_opacity;
        if (keyword == "bump" || keyword == "map_bump") texture = &m.map_bump;
        if (keyword == "norm" || keyword == "map_kn") texture = &m.map_normal;
        if (keyword == "map_pr") texture = &m.map_roughness;
        if (keyword == "map_pm") texture = &m.map_metallic;
        if (keyword == "disp" || keyword == "decal" || keyword == "refl") texture = &m.map_other;
        if (keyword == "map_aat") return true;  // antialiasing, which is on
        if (!texture) return false;
        *texture = read_texture();
        return true;
    }

    // Options come first, then the name, which may hold blanks.
    MtlTexture read_texture() {
        MtlTexture t;
        for (;;) {
            TextCursor ahead = text_;
            const std::string option = lower(ahead.word());
            if (option.size() < 2 || option.front() != '-') break;
            text_.word();
            if (!texture_option(option, t)) warn_once("the texture option " + option + " is not known");
        }
        t.file = text_.rest().substr(0, 4096);
        std::replace(t.file.begin(), t.file.end(), '\\', '/');
        return t;
    }
    bool texture_option(const std::string& option, MtlTexture& t) {
        if (option == "-o" || option == "-s" || option == "-t") {
            const Vec3 v = up_to_three(option == "-s" ? 1.0f : 0.0f);
            if (option == "-o") t.offset = {v.x, v.y};
            if (option == "-s") t.scale = {v.x, v.y};
            if (option == "-t" && !(v == Vec3{})) warn_once("turbulence of textures (-t) is not drawn");
        } else if (option == "-clamp") {
            t.clamp = lower(text_.word()) == "on";
        } else if (option == "-bm") {
            number([&](float v) { t.bump = v; });
        } else if (option == "-mm") {
            number([&](float v) { t.base = v; });
            number([&](float v) { t.gain = v; });
            if (t.base != 0 || t.gain != 1) warn_once("base and gain of textures (-mm) are not applied");
        } else if (option == "-imfchan") {
            const std::string channel = lower(text_.word());
            t.channel = channel.empty() ? '\0' : channel.front();
        } else if (option == "-blendu" || option == "-blendv" || option == "-cc" || option == "-texres" ||
                   option == "-boost" || option == "-type") {
            text_.word();  // of filters that we choose ourselves, or of reflections
        } else {
            return false;
        }
        return true;
    }

    template <class Set>
    bool number(Set&& set) {
        set(next_number());
        return true;
    }
    // r [g b], or "xyz x [y z]" in CIE coordinates, or "spectral FILE".
    template <class Set>
    bool color(Set&& set) {
        TextCursor ahead = text_;
        const std::string word = lower(ahead.word());
        if (word == "spectral") {
            warn_once("spectral curves are not read");
            return true;
        }
        const bool cie = word == "xyz";
        if (cie) text_.word();
        const float first = next_number();
        const std::optional<float> second = further(), third = further();
        const Vec3 c{first, second.value_or(first), third.value_or(first)};
        if (!cie) {
            set(c);
            return true;
        }
        // IEC 61966-2-1, CIE 1931 XYZ to linear sRGB.
        set(Vec3{3.2406f * c.x - 1.5372f * c.y - 0.4986f * c.z, -0.9689f * c.x + 1.8758f * c.y + 0.0415f * c.z,
                 0.0557f * c.x - 0.2040f * c.y + 1.0570f * c.z});
        return true;
    }
    Vec3 up_to_three(float missing) {
        const float first = next_number();
        const std::optional<float> second = further(), third = further();
        return {first, second.value_or(missing), third.value_or(missing)};
    }
    std::optional<float> further() {
        TextCursor ahead = text_;
        const std::optional<float> value = parse_float(ahead.word());
        if (!value) return std::nullopt;
        return next_number();
    }
    float next_number() {
        const std::string_view word = text_.word();
        const std::optional<float> value = parse_float(word);
        constexpr float kMost = std::numeric_limits<float>::max();
        if (!value || !(*value <= kMost && *value >= -kMost)) context_.fail(quoted(word) + " is no number", place());
        return *value;
    }

    std::string place() const { return file_ + ", " + text_.place(); }
    void warn_once(const std::string& what) {
        if (warned_.size() < 64 && warned_.insert(what).second) context_.warn(place() + ": " + what);
    }

    LoadContext& context_;
    TextCursor text_;
    const std::string& file_;
    std::vector<MtlMaterial> materials_;
    std::set<std::string> warned_;
};

}  // namespace

std::vector<MtlMaterial> read_mtl_text(LoadContext& context, std::string_view text, const std::string& file) {
    return MtlReader(context, text, file).read();
}

}  // namespace tessera
