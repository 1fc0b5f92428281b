// Fills a picture with ground and sky.
#pragma once

#include "sim/render/ground_light.h"
#include "sim/render/ground_window.h"
#include "sim/render/lighting.h"
#include "sim/render/picture.h"
#include "sim/render/sky.h"
#include "sim/render/view.h"

namespace bevloc::sim {

/// Draws every pixel of the picture; tiles that come into view are painted on the way.
void draw_ground_and_sky(const View& view, const Lighting& lighting, const GroundLight& light,
                         const Sky& sky, GroundWindow& ground, Picture& picture);

}  // namespace bevloc::sim
