// The materials of OBJ files: MTL libraries to materials, textures and pictures of a scene. What is
// missing or damaged beside the geometry is a warning: such files are common, and shapes are better
// than nothing.
#pragma once

#include "load/context.h"
#include "load/mtl.h"
#include "load/pictures.h"
#include "load/scene_files.h"

#include <tessera/scene.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

class ObjMaterials {
  public:
    // `files`: where libraries and pictures lie; it outlives this.
    ObjMaterials(LoadContext& context, const SceneFiles& files, Scene& scene);

    // What one statement `mtllib` names.
    void read_libraries(const std::string& names);
    // The scene's material of that name, or the plain one, with a warning for names that are not known.
    int find(const std::string& name);
    int plain();
    // After the last library: decodes the pictures and combines those that one material needs as one.
    void finish();

  private:
    // A picture that is put together: a channel of `from` goes to a channel of the copy of `to`.
    struct Part {
        int to, from;    // pictures; `to` may be kNone: white
        char channel;    // of `from`: r, g, b, m (alpha), l (luminance)
        int to_channel;  // 0 .. 3
        int into;        // picture, made of it
    };

    // What becomes of a factor that is 1 for the sake of a picture, where that cannot be decoded.
    struct WithoutPicture {
        int picture, material;
        void (*change)(Material& material);
    };

    bool read_library(const std::string& name, bool must_be_there);
    int add_material(const MtlMaterial& m);
    void set_opacity(const MtlMaterial& m, int number);
    void set_physical(const MtlMaterial& m, int number);
    void set_highlight(const MtlMaterial& m, int number);
    void set_glass(const MtlMaterial& m, int number);
    TextureRef texture(const MtlTexture& t);
    TextureRef texture_of(int picture, const MtlTexture& t);
    int picture(const MtlTexture& t);
    int combined(int to, int from, char channel, int to_channel);
    void combine(const Part& part);
    void choose_alpha_mode(Material& material);
    AlphaMode alpha_mode_of(int picture);
    void warn_once(const std::string& what);

    LoadContext& context_;
    const SceneFiles& files_;
    Scene& scene_;
    int plain_ = kNone;
    std::map<std::string, int> materials_;
    std::map<std::string, int> pictures_;
    std::map<std::pair<int, bool>, int> textures_;  // by picture and clamping
    std::vector<PictureFile> picture_files_;
    std::vector<Part> parts_;
    std::vector<WithoutPicture> without_picture_;
    std::map<int, AlphaMode> alpha_modes_;  // of pictures
    std::vector<int> masked_;               // materials whose alpha decides how they are drawn
    std::set<std::string> warned_;
};

}  // namespace tessera
