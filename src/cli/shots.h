// The pictures that one command draws of a scene: its cameras by its numbered frames, with the shots before and after
// each that motion is measured to. In the order in which the scene moves least.
#pragma once

#include "cli/render_arguments.h"

#include <optional>
#include <string>
#include <vector>

namespace tessera::cli {

struct PlannedShot {
    std::string camera;  // its name
    std::optional<long> frame;
    Shot now, before, after;
};

class ShotList {
  public:
    // Of a job that was set up for its scene, which must outlive this.
    explicit ShotList(const RenderJob& job);

    long count() const { return frames_ * static_cast<long>(cameras_.size()); }
    PlannedShot at(long index) const;

  private:
    Shot shot(std::size_t camera, long frame) const;

    const RenderJob& job_;
    std::vector<Pose> cameras_;
    long frames_;
};

}  // namespace tessera::cli
