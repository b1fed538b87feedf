// Where a picture is taken from, and when: views and moments. Plain data. World space is the scene's;
// pixels are counted from the top left.
#pragma once

#include <tessera/export.h>
#include <tessera/scene.h>
#include <tessera/types.h>

#include <optional>

namespace tessera {

// A pinhole camera as OpenCV has it: u = fx X / Z + cx and v = fy Y / Z + cy in pixels, where Y points down and the
// centre of the top left pixel is (0, 0). For the picture's own size.
struct Intrinsics {
    double fx = 0, fy = 0, cx = 0, cy = 0;
    friend bool operator==(const Intrinsics&, const Intrinsics&) = default;
};

// Where the camera stands. Exactly one way is used: `camera` (an index into Scene::cameras, at the
// first node that carries it), else `camera_to_world`, else `eye`/`target`, else the scene's first camera, else the
// visible bounds framed in a three-quarter view: where an animation is chosen, those of the whole of it, so that
// the camera stands still.
struct View {
    std::optional<int> camera;
    std::optional<Mat4> camera_to_world;  // rigid; the camera looks along its -Z, its Y is up in the picture
    std::optional<Vec3> eye, target;
    Vec3 up{0, 1, 0};
    std::optional<float> yfov;             // radians; default 35 degrees
    std::optional<Intrinsics> intrinsics;  // in place of any lens
    bool frame_bounds = false;             // ignore the scene's cameras
    // A turntable: the camera that was placed or framed has gone around the axis `up` by this angle (radians,
    // counter-clockwise seen from above): around the target, or the middle of the visible bounds. Framing is
    // then the same for every angle, and keeps all of them in the picture. Ignores the scene's cameras.
    std::optional<double> turn;
    // For hosts that bring their own matrices and must match another renderer to the pixel: both or
    // neither, in place of all of the above. `clip_from_world` follows OpenGL (y up, z from -w at the
    // near plane to w at the far one); of its floats x, y and w come as they are, exactly so for nodes
    // without a transform, and depth stays Tessera's: z' = (w - z) / 2. `camera_from_world` is the rigid
    // part, into the space where shading is done: eye at the origin, looking along -Z.
    std::optional<Mat4> clip_from_world, camera_from_world;

    friend bool operator==(const View&, const View&) = default;
};

// A moment of a scene's animations. Before the first key of a channel and after its last one, their values hold.
inline constexpr int kEveryAnimation = -2;
struct Moment {
    int animation = kNone;  // index into Scene::animations, kEveryAnimation, or kNone: as the nodes stand in the scene
    double time = 0;        // seconds
    friend bool operator==(const Moment&, const Moment&) = default;
};
// The time of the last key, in seconds; 0 without any.
TESSERA_API double duration(const Animation& animation);

// A moment seen from somewhere.
struct Shot {
    View view;
    Moment moment;
    friend bool operator==(const Shot&, const Shot&) = default;
};

}  // namespace tessera
