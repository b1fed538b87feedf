// The choices that materials, textures, lights and the film are made of, as plain enumerations: the
// public API and the shading kernels read the same ones.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera {

enum class ShadingModel : std::uint8_t {
    kMetallicRoughness,
    kUnlit,
    kLambert,
    kPhong,
    kBlinnPhong,
    kSpecularGlossiness
};
enum class AlphaMode : std::uint8_t { kOpaque, kMask, kBlend };

enum class LightType : std::uint8_t { kDirectional, kPoint, kSpot };
// kInverseSquare: glTF, candela over metres squared. kConstant: the light of the textbook formulas,
// whose `intensity` arrives undiminished as their I_l.
enum class LightFalloff : std::uint8_t { kInverseSquare, kConstant };
// kCones: glTF, full inside the inner cone, squared fall to zero at the outer one. kAxis: fades from
// the axis, linearly in the cosine, to zero at the outer cone.
enum class SpotProfile : std::uint8_t { kCones, kAxis };

// A texture input of the material interface. To add one: a slot here, its reader in load/, its use
// in shading/material.h. Every engine then sees it.
enum class TextureSlot : std::uint8_t {
    kBaseColor,
    kMetallicRoughness,
    kNormal,
    kOcclusion,
    kEmissive,
    kSpecular,       // alpha: the specular strength; the shininess of the Phong models
    kSpecularColor,  // sRGB: the specular colour; ks of the Phong models. Alpha: the glossiness, where the model has
                     // one
    kTransmission,   // red
    kCount
};
inline constexpr std::size_t kTextureSlots = static_cast<std::size_t>(TextureSlot::kCount);

// Whether lights cast shadows: kAuto, traced by the engines that trace light and none by the rasterizers; kNone; or
// kTraced, hard ones by rays, which kReferenceRaster has not.
enum class Shadows : std::uint8_t { kAuto, kNone, kTraced };

enum class Wrap : std::uint8_t { kRepeat, kMirror, kClamp };
enum class Filter : std::uint8_t { kNearest, kLinear };
// How a texture is filtered when it shrinks: kNone takes level 0 only.
enum class MipFilter : std::uint8_t { kNone, kNearest, kLinear };

// From exposed radiance to display values: cut off, Khronos PBR Neutral, or like ACES.
enum class ToneMap : std::uint8_t { kNone, kNeutral, kAces };
// How the 8-bit colour plane stores display values: as sRGB, or as they are (linear), for comparison
// with renderers that do not encode. Viewers expect sRGB.
enum class Encoding : std::uint8_t { kSrgb, kLinear };

// No reference. (Declared after the enumerations whose enumerator of this name would shadow it.)
inline constexpr int kNone = -1;

}  // namespace tessera
