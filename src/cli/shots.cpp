#include "cli/shots.h"

#include <algorithm>

namespace tessera::cli {

ShotList::ShotList(const RenderJob& job)
    : job_(job), cameras_(job.poses), frames_(job.frames ? job.frames->count() : 1) {
    if (cameras_.empty()) cameras_.push_back({job.camera.empty() ? "default" : job.camera, job.render.view});
}

Shot ShotList::shot(std::size_t camera, long frame) const {
    Shot s{cameras_[camera].view, job_.render.moment};
    if (job_.frames) {
        s.view = job_.frames->view(s.view, frame);
        s.moment = job_.frames->moment(s.moment, frame);
    }
    return s;
}

PlannedShot ShotList::at(long index) const {
    const auto cameras = static_cast<long>(cameras_.size());
    const auto camera = static_cast<std::size_t>(index % cameras);
    PlannedShot p;
    p.camera = cameras_[camera].name;
    if (!job_.frames) {
        p.now = p.before = p.after = shot(camera, 0);
        if (job_.render.moment.animation != kNone) {
            // A frame away, as if this were one of a sequence.
            p.before.moment.time -= 1 / job_.fps;
            p.after.moment.time += 1 / job_.fps;
        } else {
            p.before = shot(camera == 0 ? 0 : camera - 1, 0);
            p.after = shot(std::min(camera + 1, cameras_.size() - 1), 0);
        }
        return p;
    }
    p.frame = job_.frames->first + index / cameras;
    p.now = shot(camera, *p.frame);
    p.before = shot(camera, *p.frame - 1);
    p.after = shot(camera, *p.frame + 1);
    return p;
}

}  // namespace tessera::cli
