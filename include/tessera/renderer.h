// A renderer that stays warm: made once for a scene and options, it draws again and again from any
// view, without repeating what does not change between frames (checks, prepared meshes, mip chains,
// threads). A Renderer belongs to one thread at a time; any number of them may run at once, also on
// one scene. Throws tessera::Error as render() does.
#pragma once

#include <tessera/export.h>
#include <tessera/render.h>

#include <memory>

namespace tessera {

class TESSERA_API Renderer {
  public:
    // Checks the options and the scene and prepares them. `scene` must outlive the renderer unchanged.
    Renderer(const Scene& scene, const RenderOptions& options);
    ~Renderer();
    Renderer(Renderer&& other) noexcept;
    Renderer& operator=(Renderer&& other) noexcept;

    // Draws from the options' view at their moment, or from another one. Planes of `result` that have the right size
    // and format are written over, the others replaced: give it the same one again, and no picture is allocated. Its
    // statistics and warnings are those of this frame; color_hash is left 0. After an exception the planes hold nothing
    // of use.
    void draw(RenderResult& result);
    void draw(const View& view, RenderResult& result);
    // At another moment. What does not move is not made again.
    void draw(const View& view, const Moment& moment, RenderResult& result);
    // And with motion measured to these shots.
    void draw(const Shot& now, const Shot& before, const Shot& after, RenderResult& result);

    const RenderOptions& options() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tessera
