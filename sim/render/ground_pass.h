// Renders the ground and the sky into an image.
#pragma once

#include "sim/render/ground_light.h"
#include "sim/render/ground_window.h"
#include "sim/render/lighting.h"
#include "sim/render/linear_image.h"
#include "sim/render/sky.h"
#include "sim/render/view.h"

namespace bevloc::sim {

/// Overwrites the colour of every pixel, and its nearness. Flat ground hides nothing, but a crest
/// hides what is behind it. Ground tiles that are not painted yet are painted.
void draw_ground_and_sky(const View& view, const Lighting& lighting, const GroundLight& light,
                         const Sky& sky, GroundWindow& ground, LinearImage& image);

}  // namespace bevloc::sim
