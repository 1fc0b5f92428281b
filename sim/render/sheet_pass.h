// Draws sheets over a picture of ground and sky.
#pragma once

#include <span>

#include "sim/render/lighting.h"
#include "sim/render/picture.h"
#include "sim/render/sheet.h"
#include "sim/render/view.h"

namespace bevloc::sim {

/// `sheets` come far ones first; nearness in the picture settles what that order leaves open.
void draw_sheets(const View& view, const Lighting& lighting, std::span<const Sheet> sheets,
                 Picture& picture);

}  // namespace bevloc::sim
