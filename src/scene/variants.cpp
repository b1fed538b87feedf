// Variants: sets of materials, of which a scene shows one.
#include <tessera/error.h>
#include <tessera/scene.h>

namespace tessera {

void choose_variant(Scene& scene, int variant) {
    const int count = static_cast<int>(scene.variants.size());
    if (variant < 0 || variant >= count)
        throw Error(ErrorCode::kUsage,
                    "variant " + std::to_string(variant) + " does not exist: the scene has " + std::to_string(count));
    for (Mesh& mesh : scene.meshes)
        for (Primitive& p : mesh.primitives) {
            if (p.variants.empty()) continue;
            // The default is kept for the next choice.
            if (p.variants.back().variant != kNone) p.variants.push_back({kNone, p.material});
            p.material = p.variants.back().material;
            for (const VariantMaterial& v : p.variants)
                if (v.variant == variant) p.material = v.material;
        }
}

}  // namespace tessera
