// The scene of the command line: loading it, and what options say about its parts.
#pragma once

#include <tessera/load.h>
#include <tessera/render.h>

#include <string>

namespace tessera::cli {

// Loads `path`, or standard input for "-"; a scene from standard input may use no other files.
// Errors name the file.
Scene load_input(const std::string& path, const LoadOptions& options);

// What `path` is called in messages.
std::string input_name(const std::string& path);

// The index of the camera that `text` names (its own name, that of a node which carries it, or a
// number); kUsage with the names that there are otherwise.
int find_camera(const Scene& scene, const std::string& text);

// The index of the animation that `text` names (its name or a number), or kEveryAnimation for "all"; kUsage
// with the names that there are otherwise.
int find_animation(const Scene& scene, const std::string& text);

// The index of the variant that `text` names (its name or a number); kUsage with the names that there are
// otherwise.
int find_variant(const Scene& scene, const std::string& text);

// Turns a scene whose up axis is Z into one with Y up, exactly: (x, y, z) becomes (x, z, -y).
void turn_z_up(Scene& scene);
Vec3 turn_z_up(Vec3 point);

}  // namespace tessera::cli
