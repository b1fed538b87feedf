#include "load/texcoord_check.h"

#include "load/text.h"

#include <string>
#include <vector>

namespace tessera {
namespace {

// The first set that a texture of the material wants and a primitive with `sets` does not have, or kNone.
int missing_set(const Material& material, std::size_t sets) {
    for (const TextureRef& ref : material.textures)
        if (ref.texture != kNone && static_cast<std::size_t>(ref.uv_set) >= sets) return ref.uv_set;
    return kNone;
}

}  // namespace

void warn_of_missing_texcoords(LoadContext& context, const Scene& scene) {
    std::vector<char> named(scene.materials.size(), 0);
    const auto check = [&](int number, const Primitive& p) {
        if (number == kNone || p.positions.empty() || named[static_cast<std::size_t>(number)]) return;
        const Material& material = scene.materials[static_cast<std::size_t>(number)];
        const int set = missing_set(material, p.texcoords.size());
        if (set == kNone) return;
        named[static_cast<std::size_t>(number)] = 1;
        std::string text = "material " + std::to_string(number);
        if (!material.name.empty()) text.append(" ").append(quoted(material.name));
        context.warn(text.append(" has a texture over the texture coordinates ")
                         .append(std::to_string(set))
                         .append(", which a primitive with it does not have"));
    };
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives) {
            check(p.material, p);
            for (const VariantMaterial& variant : p.variants) check(variant.material, p);
        }
}

}  // namespace tessera
