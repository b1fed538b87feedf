// Cameras, lights, materials, textures and pictures.
#include "scene/check.h"

#include <limits>

namespace tessera {
namespace {

constexpr float kPi = 3.14159265f;

void check_camera(const Camera& camera, const Place& place) {
    const float values[] = {
        camera.yfov, camera.xmag, camera.ymag, camera.znear, camera.zfar.value_or(1), camera.aspect.value_or(1)};
    place.finite(values, std::size(values));
    if (camera.type == Camera::Type::kPerspective) {
        if (!(camera.yfov > 0 && camera.yfov < kPi)) place.child("yfov").fail("must be above 0 and below pi");
        if (!(camera.znear > 0)) place.child("znear").fail("must be above 0");
        if (camera.aspect && !(*camera.aspect > 0)) place.child("aspect").fail("must be above 0");
    } else {
        if (camera.xmag == 0) place.child("xmag").fail("must not be 0");
        if (camera.ymag == 0) place.child("ymag").fail("must not be 0");
        if (!(camera.znear >= 0)) place.child("znear").fail("must not be negative");
        if (!camera.zfar) place.child("zfar").fail("an orthographic camera needs a far plane");
    }
    if (camera.zfar && !(*camera.zfar > camera.znear)) place.child("zfar").fail("must be beyond znear");
}

void check_light(const Light& light, const Place& place) {
    const float values[] = {light.color.x,    light.color.y,           light.color.z,   light.intensity,
                            light.inner_cone, light.range.value_or(1), light.outer_cone};
    place.finite(values, std::size(values));
    if (light.intensity < 0) place.child("intensity").fail("must not be negative");
    if (light.range && !(*light.range > 0)) place.child("range").fail("must be above 0");
    if (light.type == Light::Type::kSpot &&
        !(light.inner_cone >= 0 && light.inner_cone <= light.outer_cone && light.outer_cone <= kPi / 2 + 1e-5f))
        place.child("outer_cone").fail("cones must satisfy 0 <= inner <= outer <= pi/2");
}

void check_texture(const Scene& scene, const TextureRef& ref, const Place& place) {
    place.reference(ref.texture, scene.textures.size(), "texture");
    if (ref.uv_set < 0) place.child("uv_set").fail("must not be negative");
    const float transform[] = {ref.offset.x, ref.offset.y, ref.scale.x, ref.scale.y, ref.rotation};
    place.finite(transform, std::size(transform));
}

// The layers and the inside of a material, whose numbers have the ranges of glTF's extensions.
void check_extensions(const Scene& scene, const Material& m, const Place& place) {
    constexpr float kAny = std::numeric_limits<float>::max();
    const struct {
        const char *part, *name;
        float value, least, most;
    } numbers[] = {
        {"clearcoat", "strength", m.clearcoat.strength, 0, 1},
        {"clearcoat", "roughness", m.clearcoat.roughness, 0, 1},
        {"clearcoat", "normal_scale", m.clearcoat.normal_scale, -kAny, kAny},
        {"sheen", "color", m.sheen.color.x, 0, 1},
        {"sheen", "color", m.sheen.color.y, 0, 1},
        {"sheen", "color", m.sheen.color.z, 0, 1},
        {"sheen", "roughness", m.sheen.roughness, 0, 1},
        {"transmission", {}, m.transmission, 0, 1},
        {"volume", "thickness", m.volume.thickness, 0, kAny},
        {"volume", "attenuation_color", m.volume.attenuation_color.x, 0, 1},
        {"volume", "attenuation_color", m.volume.attenuation_color.y, 0, 1},
        {"volume", "attenuation_color", m.volume.attenuation_color.z, 0, 1},
        {"anisotropy", "strength", m.anisotropy.strength, 0, 1},
        {"anisotropy", "rotation", m.anisotropy.rotation, -kAny, kAny},
        {"iridescence", "strength", m.iridescence.strength, 0, 1},
        {"iridescence", "ior", m.iridescence.ior, 1, kAny},
        {"iridescence", "thickness_at_black", m.iridescence.thickness_at_black, 0, kAny},
        {"iridescence", "thickness_at_white", m.iridescence.thickness_at_white, 0, kAny},
        {"dispersion", {}, m.dispersion, 0, kAny},
    };
    for (const auto& n : numbers) {
        if (n.value >= n.least && n.value <= n.most) continue;
        const Place part = place.child(n.part);
        (n.name ? part.child(n.name) : part).fail("is out of range");
    }
    if (const auto& distance = m.volume.attenuation_distance; distance && !(*distance > 0 && *distance <= kAny))
        place.child("volume").child("attenuation_distance").fail("must be above 0");
    const struct {
        const char *part, *name;
        const TextureRef& ref;
    } textures[] = {
        {"clearcoat", "strength_texture", m.clearcoat.strength_texture},
        {"clearcoat", "roughness_texture", m.clearcoat.roughness_texture},
        {"clearcoat", "normal_texture", m.clearcoat.normal_texture},
        {"sheen", "color_texture", m.sheen.color_texture},
        {"sheen", "roughness_texture", m.sheen.roughness_texture},
        {"volume", "thickness_texture", m.volume.thickness_texture},
        {"anisotropy", "texture", m.anisotropy.texture},
        {"iridescence", "texture", m.iridescence.texture},
        {"iridescence", "thickness_texture", m.iridescence.thickness_texture},
    };
    for (const auto& t : textures) {
        const Place part = place.child(t.part);
        check_texture(scene, t.ref, part.child(t.name));
    }
}

void check_material(const Scene& scene, const Material& m, const Place& place) {
    const float values[] = {
        m.base_color.x,      m.base_color.y,     m.base_color.z,       m.base_color.w,      m.metallic,     m.roughness,
        m.emissive.x,        m.emissive.y,       m.emissive.z,         m.emissive_strength, m.normal_scale, m.ambient.x,
        m.ambient.y,         m.ambient.z,        m.occlusion_strength, m.diffuse.x,         m.diffuse.y,    m.diffuse.z,
        m.specular.x,        m.specular.y,       m.specular.z,         m.shininess,         m.alpha_cutoff, m.ior,
        m.specular_strength, m.specular_color.x, m.specular_color.y,   m.specular_color.z};
    place.finite(values, std::size(values));
    for (std::size_t s = 0; s < kTextureSlots; ++s) check_texture(scene, m.textures[s], place.child("textures", s));
    check_extensions(scene, m, place);
}

}  // namespace

void check_appearance(const Scene& scene) {
    if (scene.ambient) {
        const float values[] = {scene.ambient->x, scene.ambient->y, scene.ambient->z};
        Place{nullptr, "ambient", 0}.finite(values, std::size(values));
    }
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) check_camera(scene.cameras[i], Place{nullptr, "cameras", i});
    for (std::size_t i = 0; i < scene.lights.size(); ++i) check_light(scene.lights[i], Place{nullptr, "lights", i});
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
        check_material(scene, scene.materials[i], Place{nullptr, "materials", i});
    for (std::size_t i = 0; i < scene.textures.size(); ++i) {
        const Place place{nullptr, "textures", i};
        place.reference(scene.textures[i].picture, scene.pictures.size(), "picture");
        place.reference(scene.textures[i].sampler, scene.samplers.size(), "sampler");
    }
    for (std::size_t i = 0; i < scene.pictures.size(); ++i) {
        const Image* pixels = scene.pictures[i].pixels.get();
        if (!pixels) continue;
        const Place place = Place{nullptr, "pictures", i};
        if (pixels->empty()) place.child("pixels").fail("the picture has no pixels");
        if (pixels->format() != PixelFormat::kRgba8 && pixels->format() != PixelFormat::kRgba16)
            place.child("pixels").fail("a picture holds RGBA of 8 or 16 bits");
    }
}

}  // namespace tessera
