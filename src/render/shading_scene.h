// The scene as shading reads it: materials with their textures' mip chains, lights and ambient light
// in camera space. Owns what its ShadingContext points to.
#pragma once

#include <tessera/render.h>

#include "core/parallel.h"
#include "geometry/frame.h"
#include "image/mipmap.h"
#include "shading/film.h"
#include "shading/shade.h"

#include <string>
#include <vector>

namespace tessera {

class ShadingScene {
  public:
    // Materials and textures, of the materials that `used` marks (PreparedScene::used_materials). Builds mip
    // chains in parallel. `warnings` receives what cannot be honoured.
    ShadingScene(const Scene& scene, const std::vector<bool>& used, Arena& arena, std::vector<std::string>& warnings);
    // The same for one frame, and its lights.
    ShadingScene(const Scene& scene, const Frame& frame, const RenderOptions& options, Arena& arena,
                 std::vector<std::string>& warnings);
    ShadingScene(const ShadingScene&) = delete;
    ShadingScene& operator=(const ShadingScene&) = delete;

    // Lights and exposure of a frame, in place of an earlier one's.
    void light(const Scene& scene, const Frame& frame, const RenderOptions& options);

    const ShadingContext& context() const { return context_; }
    double exposure() const { return exposure_; }
    // The film for these options. Where nothing but unlit materials is drawn their colours are display
    // colours, and no tone map touches them.
    FilmView film(const RenderOptions& options) const;

  private:
    std::vector<MipChain> chains_;
    std::vector<TextureView> textures_;
    std::vector<MaterialView> materials_;
    std::vector<LightView> lights_;
    ShadingContext context_{};
    double exposure_ = 1;
    bool all_unlit_ = false;
};

}  // namespace tessera
