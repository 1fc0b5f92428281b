// Renders panels over an image of ground and sky.
#pragma once

#include <span>

#include "sim/render/lighting.h"
#include "sim/render/linear_image.h"
#include "sim/render/panel.h"
#include "sim/render/view.h"

namespace bevloc::sim {

/// Draws over `image` and its nearness. `panels` must be sorted from far to near; the
/// nearness buffer corrects pixels where that order is wrong.
void draw_panels(const View& view, const Lighting& lighting, std::span<const Panel> panels,
                 LinearImage& image);

}  // namespace bevloc::sim
