// Materials and textures of a scene: the material interface that every engine sees. Colours are
// linear Rec. 709; texture coordinates have their origin at the top left of the picture (glTF).
// Plain data; references are indices into the vectors of Scene (kNone: absent).
#pragma once

#include <tessera/image.h>
#include <tessera/shading_model.h>
#include <tessera/types.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace tessera {

// --- textures -------------------------------------------------------------------------------

struct Sampler {
    std::string name;
    Filter mag_filter = Filter::kLinear, min_filter = Filter::kLinear;
    MipFilter mip_filter = MipFilter::kLinear;
    Wrap wrap_s = Wrap::kRepeat, wrap_t = Wrap::kRepeat;
};

// Decoded pixels (kRgba8 or kRgba16), shared between copies of a scene. The colour space is that of
// the texture slot that uses them: sRGB for base colour and emission, linear for the others.
struct Picture {
    std::string name, uri;
    std::shared_ptr<const Image> pixels;  // null: not loaded; the texture is then left out
    std::string extras;                   // raw JSON, "" when absent; the same for every `extras` below
};

struct Texture {
    std::string name;
    int picture = kNone;
    int sampler = kNone;  // kNone: repeat, trilinear
    std::string extras;
};

// --- materials ------------------------------------------------------------------------------

struct TextureRef {
    int texture = kNone;
    int uv_set = 0;
    // KHR_texture_transform: uv' = translate(offset) * rotate(rotation) * scale(scale) * uv.
    Vec2 offset{0, 0}, scale{1, 1};
    float rotation = 0;
    friend bool operator==(const TextureRef&, const TextureRef&) = default;
};

// What glTF's extensions of these names describe, as data: a strength of 0 is none of it. A texture multiplies its
// factor by the channel that is named. Engines use what they can; pictures that nothing draws with stay undecoded.

struct Clearcoat {  // a clear lacquer on top
    float strength = 0, roughness = 0, normal_scale = 1;
    TextureRef strength_texture, roughness_texture, normal_texture;  // red, green, a normal map
    friend bool operator==(const Clearcoat&, const Clearcoat&) = default;
};
struct Sheen {  // the fibres of cloth
    Vec3 color{0, 0, 0};
    float roughness = 0;
    TextureRef color_texture, roughness_texture;  // sRGB, alpha
    friend bool operator==(const Sheen&, const Sheen&) = default;
};
struct Volume {                                 // below the surface; thickness 0: there is none, the surface is thin
    float thickness = 0;                        // metres, in the space of the mesh
    TextureRef thickness_texture;               // green
    std::optional<float> attenuation_distance;  // metres in the world, after which light has the colour; none: infinite
    Vec3 attenuation_color{1, 1, 1};
    int priority = 0;  // where volumes overlap the highest one fills the space
    friend bool operator==(const Volume&, const Volume&) = default;
};
struct Anisotropy {  // highlights stretched along a direction, counter-clockwise from the tangent in radians
    float strength = 0, rotation = 0;
    TextureRef texture;  // direction in red and green, strength in blue
    friend bool operator==(const Anisotropy&, const Anisotropy&) = default;
};
struct Iridescence {  // a thin film
    float strength = 0, ior = 1.3f;
    float thickness_at_black = 100, thickness_at_white = 400;  // nanometres, by the texture; without one: the latter
    TextureRef texture, thickness_texture;                     // red, green
    friend bool operator==(const Iridescence&, const Iridescence&) = default;
};

struct Material {
    std::string name;
    ShadingModel model = ShadingModel::kMetallicRoughness;

    // Metallic-roughness and unlit. The alpha of base_color is the material's alpha in every model.
    // Specular-glossiness: base_color is its diffuse colour, specular_color its reflectance, 1 - roughness its
    // glossiness; metallic and ior do not count.
    Vec4 base_color{1, 1, 1, 1};
    float metallic = 1, roughness = 1;
    Vec3 emissive{0, 0, 0};  // ke of the Phong models
    float emissive_strength = 1;
    float normal_scale = 1, occlusion_strength = 1;
    // What the part that is no metal reflects at normal incidence: ((ior - 1) / (ior + 1))^2 times the colour, times
    // the strength, which also counts at grazing angles. An index of 0 stands for an infinite one (glTF).
    float ior = 1.5f, specular_strength = 1;
    Vec3 specular_color{1, 1, 1};

    // Lambert, Phong and Blinn-Phong (linear colours); the base-colour texture modulates ka and kd.
    Vec3 ambient{0, 0, 0}, diffuse{0.8f, 0.8f, 0.8f}, specular{0, 0, 0};  // ka, kd, ks
    float shininess = 32;                                                 // ns
    Vec3 mirror{0, 0, 0};                                                 // kr: of light that is traced

    std::array<TextureRef, kTextureSlots> textures;
    TextureRef& texture(TextureSlot s) { return textures[static_cast<std::size_t>(s)]; }
    const TextureRef& texture(TextureSlot s) const { return textures[static_cast<std::size_t>(s)]; }

    Clearcoat clearcoat;
    Sheen sheen;
    // The part of the light that enters the surface instead of being scattered, coloured by base_color: through to the
    // other side of thin surfaces, refracted into volumes. Drawn by the engines that trace light.
    float transmission = 0;
    Volume volume;
    Anisotropy anisotropy;
    Iridescence iridescence;
    float dispersion = 0;  // 20 over the Abbe number; 0: none

    AlphaMode alpha_mode = AlphaMode::kOpaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    std::string extras;
};

}  // namespace tessera
