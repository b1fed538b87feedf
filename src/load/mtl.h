// Wavefront MTL: materials as the file has them. https://paulbourke.net/dataformats/mtl/ describes the
// statements; Pr, Pm, norm and their maps are a later extension for physically based materials.
#pragma once

#include "load/context.h"

#include <tessera/types.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

struct MtlTexture {
    std::string file;  // as written, with forward slashes; empty: none
    Vec2 offset{0, 0}, scale{1, 1};
    bool clamp = false;
    float bump = 1;            // -bm
    char channel = 0;          // -imfchan: r g b m l z; 0: not said
    float base = 0, gain = 1;  // -mm
};

struct MtlMaterial {
    std::string name;
    std::optional<Vec3> ambient;                                           // Ka
    Vec3 diffuse{0.8f, 0.8f, 0.8f}, specular{0, 0, 0}, emission{0, 0, 0};  // Kd, Ks, Ke
    bool has_opacity = false;                                              // d was there
    float shininess = 32, opacity = 1, ior = 1.5f;                         // Ns, d, Ni
    Vec3 filter{1, 1, 1};                                                  // Tf
    std::optional<float> roughness, metallic;                              // Pr, Pm
    int illumination = 2;                                                  // illum
    MtlTexture map_ambient, map_diffuse, map_specular, map_emission, map_shininess, map_opacity, map_bump, map_normal,
        map_roughness, map_metallic, map_other;
};

// `file` names the text in errors and warnings. Statements with numbers that are none are left out, with a warning
// each.
std::vector<MtlMaterial> read_mtl_text(LoadContext& context, std::string_view text, const std::string& file);

}  // namespace tessera
