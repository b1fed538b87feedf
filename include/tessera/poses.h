// Cameras from a JSON file, for many pictures of one scene: Tessera's own form, and the transforms.json of
// NeRF's data sets. The file is hostile until checked: a fault throws tessera::Error (kInput) that names the
// place. Any thread may call.
//
// Own form; matrices are rows, placements rigid:
//   {"convention": "opencv",                   or "opengl": the camera looks along +Z, Y down; or along -Z, Y up
//    "width": 640, "height": 480,              of the pictures, where the file has intrinsics
//    "intrinsics": [fx, fy, cx, cy],           for all cameras without their own
//    "cameras": [{"name": "left",              default: the number in the list
//                 "camera_to_world": [[...], [...], [...], [0, 0, 0, 1]],    or "world_to_camera"; 3 rows will do
//                 "intrinsics": [...]}]}
// transforms.json (Mildenhall et al. 2020): "frames" with "file_path" and "transform_matrix" (OpenGL); the lens from
// "fl_x", "fl_y", "cx", "cy", for all or for each, or "camera_angle_x" (radians). There cx counts from the picture's
// left edge, half a pixel more than in OpenCV.
#pragma once

#include <tessera/export.h>
#include <tessera/view.h>

#include <string>
#include <string_view>
#include <vector>

namespace tessera {

struct Pose {
    std::string name;  // no two are equal
    View view;         // camera_to_world, and intrinsics where the file has them
};

// For pictures of width x height pixels; a file that states another size for its intrinsics is refused.
TESSERA_API std::vector<Pose> read_poses(const std::string& path, int width, int height);
TESSERA_API std::vector<Pose> parse_poses(std::string_view json, int width, int height,
                                          const std::string& name = "<memory>");

}  // namespace tessera
