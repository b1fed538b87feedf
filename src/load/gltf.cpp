// The reading of a glTF document on one page.
#include "load/gltf.h"

#include "load/gltf_parts.h"
#include "load/texcoord_check.h"
#include "scene/check.h"

namespace tessera {
namespace {

// Runs one of the scene's own checks; the place in the scene is, but for a few names, the JSON path.
template <class Check>
void check_input(const LoadContext& context, Check&& check) {
    try {
        check();
    } catch (const Error& error) {
        context.fail(error.message(), "/" + error.location());
    }
}

}  // namespace

Scene read_gltf(LoadContext& context, std::string_view json, std::optional<std::span<const std::byte>> binary,
                const SceneFiles& files) {
    GltfDocument document(context, json, binary, files);
    Scene scene;
    read_header(document, scene);
    make_room(document, GltfArray::kMeshes, scene.meshes);
    read_cameras(document, scene);
    read_nodes(document, scene, read_lights(document, scene));
    read_skins(document, scene);
    check_input(context, [&] { check_hierarchy(scene); });
    check_triangle_limit(document, scene);

    read_textures(document, scene);
    read_materials(document, scene);
    read_meshes(document, scene);
    read_animations(document, scene);
    // Numbers and indices were checked while they were read.
    check_input(context, [&] {
        check_appearance(scene);
        check_meshes(scene, false);
        check_animations(scene, false);
    });
    warn_of_missing_texcoords(context, scene);
    read_pictures(document, scene);

    scene.extensions_ignored = document.ignored_extensions();
    scene.warnings = context.warnings();
    return scene;
}

void read_header(GltfDocument& document, Scene& scene) {
    const Json root = document.root(), asset = root.at("asset");
    scene.generator = asset.string_or("generator");
    scene.copyright = asset.string_or("copyright");
    scene.extras = root.raw_or_empty("extras");
    if (const std::optional<Json> required = root.find("extensionsRequired"))
        required->each([&](const Json& name, std::size_t) {
            if (name.string() == "KHR_texture_basisu")
                name.fail("the file needs the extension KHR_texture_basisu; pictures in KTX2 are not read");
            if (!is_known_extension(name.string()))
                name.fail("the file needs the extension " + std::string(name.string()) + ", which is not supported");
            scene.extensions_required.emplace_back(name.string());
        });
    if (const std::optional<Json> used = root.find("extensionsUsed"))
        used->each([&](const Json& name, std::size_t) {
            scene.extensions_used.emplace_back(name.string());
            document.note_extension(name.string());
        });
    document.note_extensions(root);
    if (const std::optional<Json> variants = find_extension(root, "KHR_materials_variants"))
        variants->at("variants").each([&](const Json& variant, std::size_t) {
            document.context().charge(sizeof(std::string) + 64, variant.place());
            scene.variants.emplace_back(variant.at("name").string());
        });
}

}  // namespace tessera
