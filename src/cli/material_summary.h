// What `tessera info` says of a material: model, alpha, and what differs from the defaults of the layers
// and the inside, with the units of tessera/material.h.
#pragma once

#include "cli/json_writer.h"

#include <tessera/scene.h>

#include <string>

namespace tessera::cli {

// "metallic-roughness, opaque, transmission 1, volume 0.2 m"
std::string material_text(const Material& material);
// Members of the object that is open.
void write_material(JsonWriter& json, const Material& material);

// A number as reports for people have it: six digits.
std::string number(double value);
// [x, y, z]
void write(JsonWriter& json, Vec3 v);

}  // namespace tessera::cli
