// Everything of Tessera's public API, and its version.
#pragma once

#include <tessera/clip.h>
#include <tessera/error.h>
#include <tessera/image.h>
#include <tessera/image_files.h>
#include <tessera/load.h>
#include <tessera/planes.h>
#include <tessera/poses.h>
#include <tessera/render.h>
#include <tessera/renderer.h>
#include <tessera/scene.h>
#include <tessera/shape.h>
#include <tessera/threads.h>
#include <tessera/transform.h>
#include <tessera/types.h>
#include <tessera/version.h>
