#include "cli/scene_setup.h"

#include "cli/parse.h"
#include "cli/scene_input.h"

#include <tessera/error.h>

namespace tessera::cli {
namespace {

// Applies what the options say about the scene itself.
void place_view(RenderJob& job, Scene& scene) {
    View& view = job.render.view;
    if (!job.camera.empty()) view.camera = find_camera(scene, job.camera);
    if (job.z_is_up) {
        turn_z_up(scene);
        if (view.eye) view.eye = turn_z_up(*view.eye);
        if (view.target) view.target = turn_z_up(*view.target);
        const Mat4 turn{{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}};
        for (Pose& pose : job.poses) pose.view.camera_to_world = turn * *pose.view.camera_to_world;
        job.render.label_from_world = transpose(turn);  // labels speak of the file's own axes
    }
    if (view.eye && !view.target) {
        const Bounds3 bounds = visible_bounds(scene);
        view.target = bounds.empty() ? Vec3{} : (bounds.min + bounds.max) * 0.5f;
        if (*view.target == *view.eye)
            throw Error(ErrorCode::kUsage, "--eye: is the middle of the scene; give --target");
    }
}

// Which moment of which animation, once the scene is there to ask.
void choose_moment(RenderJob& job, const Scene& scene) {
    const bool plays = job.frames && job.frames->plays;
    if (job.animation.empty() && !job.time && !plays) return;
    if (scene.animations.empty())
        refuse(job.time ? "--time" : plays ? "--frames" : "--animation", "the scene has no animations");
    job.render.moment.animation = job.animation.empty() ? 0 : find_animation(scene, job.animation);
    job.render.moment.time = job.time.value_or(0);
}

}  // namespace

void set_up(RenderJob& job, Scene& scene) {
    if (!job.variant.empty()) choose_variant(scene, find_variant(scene, job.variant));
    choose_moment(job, scene);
    place_view(job, scene);
}

}  // namespace tessera::cli
