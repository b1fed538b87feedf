// Cameras, and the lights of KHR_lights_punctual and TESSERA_lights.
#include "load/gltf_parts.h"

namespace tessera {
namespace {

constexpr float kHalfPi = 1.57079633f;
constexpr float kWidest = 3.12f;  // just below pi: a wider view shows nothing but its centre

Camera read_camera(GltfDocument& document, const Json& json) {
    Camera camera;
    document.note_extensions(json);
    camera.name = json.string_or("name");
    camera.extras = json.raw_or_empty("extras");
    const Json type = json.at("type");
    if (type.string() == "perspective") {
        const Json lens = json.at("perspective");
        camera.yfov = lens.at("yfov").number();
        if (camera.yfov >= kWidest) {
            document.context().warn(lens.place() + ": a field of view of pi or more is taken as a little less");
            camera.yfov = kWidest;
        }
        camera.znear = lens.at("znear").number();
        if (const std::optional<Json> aspect = lens.find("aspectRatio")) camera.aspect = aspect->number();
        if (const std::optional<Json> zfar = lens.find("zfar")) camera.zfar = zfar->number();
    } else if (type.string() == "orthographic") {
        const Json lens = json.at("orthographic");
        camera.type = Camera::Type::kOrthographic;
        camera.xmag = lens.at("xmag").number();
        camera.ymag = lens.at("ymag").number();
        camera.znear = lens.at("znear").number();
        camera.zfar = lens.at("zfar").number();
    } else {
        type.fail("there is no camera type " + type.raw());
    }
    return camera;
}

void read_spot(LoadContext& context, const Json& json, Light& light) {
    const std::optional<Json> spot = json.find("spot");
    if (!spot) {
        context.warn(json.place() + ": spot light without cones, the defaults are taken");
        return;
    }
    light.inner_cone = spot->number_or("innerConeAngle", light.inner_cone);
    light.outer_cone = spot->number_or("outerConeAngle", light.outer_cone);
    const bool valid = light.inner_cone >= 0 && light.inner_cone <= light.outer_cone && light.outer_cone <= kHalfPi;
    if (valid) return;
    context.warn(spot->place() + ": the cones do not satisfy 0 <= inner <= outer <= pi/2 and are clamped");
    light.outer_cone = light.outer_cone < 0 ? 0 : light.outer_cone > kHalfPi ? kHalfPi : light.outer_cone;
    light.inner_cone = light.inner_cone < 0                  ? 0
                       : light.inner_cone > light.outer_cone ? light.outer_cone
                                                             : light.inner_cone;
}

// The lights of the textbooks: TESSERA_lights on a light.
void read_textbook_light(LoadContext& context, const Json& json, Light& light) {
    const std::optional<Json> extension = find_extension(json, "TESSERA_lights");
    if (!extension) return;
    if (const std::optional<Json> falloff = extension->find("falloff")) {
        if (falloff->string() == "constant")
            light.falloff = LightFalloff::kConstant;
        else if (falloff->string() != "inverse-square")
            context.warn(falloff->place() + ": unknown falloff, inverse-square is taken");
    }
    if (const std::optional<Json> profile = extension->find("spotProfile")) {
        if (profile->string() == "axis")
            light.spot_profile = SpotProfile::kAxis;
        else if (profile->string() != "cones")
            context.warn(profile->place() + ": unknown spot profile, cones is taken");
    }
}

// Empty for a type that is not known.
std::optional<Light> read_light(GltfDocument& document, const Json& json) {
    LoadContext& context = document.context();
    document.note_extensions(json);
    Light light;
    light.name = json.string_or("name");
    light.extras = json.raw_or_empty("extras");
    const Json type = json.at("type");
    if (type.string() == "directional") {
        light.type = Light::Type::kDirectional;
    } else if (type.string() == "point") {
        light.type = Light::Type::kPoint;
    } else if (type.string() == "spot") {
        light.type = Light::Type::kSpot;
        read_spot(context, json, light);
    } else {
        context.warn(type.place() + ": lights of type " + type.raw() + " are ignored");
        return std::nullopt;
    }
    read_textbook_light(context, json, light);
    json.numbers_or_keep("color", {&light.color.x, 3});
    light.intensity = json.number_or("intensity", light.intensity);
    if (light.intensity < 0) {
        context.warn(json.place() + ": a negative intensity is taken as 0");
        light.intensity = 0;
    }
    if (const std::optional<Json> range = json.find("range")) {
        if (range->number() > 0)
            light.range = range->number();
        else
            context.warn(range->place() + ": a range that is not above 0 is ignored");
    }
    return light;
}

}  // namespace

void read_cameras(GltfDocument& document, Scene& scene) {
    make_room(document, GltfArray::kCameras, scene.cameras);
    document.each(GltfArray::kCameras,
                  [&](const Json& json, std::size_t i) { scene.cameras[i] = read_camera(document, json); });
}

std::vector<int> read_lights(GltfDocument& document, Scene& scene) {
    std::vector<int> numbers;
    if (const std::optional<Json> ours = find_extension(document.root(), "TESSERA_lights"))
        if (const std::optional<Json> ambient = ours->find("ambient")) {
            Vec3 radiance;
            ambient->numbers({&radiance.x, 3});
            if (radiance.x >= 0 && radiance.y >= 0 && radiance.z >= 0)
                scene.ambient = radiance;
            else
                document.context().warn(ambient->place() + ": negative ambient light is ignored");
        }
    const std::optional<Json> extension = find_extension(document.root(), "KHR_lights_punctual");
    if (!extension) return numbers;
    if (const std::optional<Json> lights = extension->find("lights"))
        lights->each([&](const Json& json, std::size_t) {
            document.context().charge(sizeof(Light), json.place());
            std::optional<Light> light = read_light(document, json);
            numbers.push_back(light ? static_cast<int>(scene.lights.size()) : kNone);
            if (light) scene.lights.push_back(std::move(*light));
        });
    return numbers;
}

}  // namespace tessera
