// Computes the part of the image in which a panel can appear.
#pragma once

#include <optional>

#include "sim/render/panel.h"
#include "sim/render/view.h"

namespace bevloc::sim {

/// A box of pixels; `right` and `bottom` belong to it.
struct PixelBox {
  int left, top, right, bottom;
};

/// A pixel box around the visible part of a panel, or nothing if no part is visible.
/// `corners_camera` are the four corners in order, in the camera frame.
std::optional<PixelBox> pixels_of(const std::array<Eigen::Vector3f, 4>& corners_camera,
                                  const CameraRays& rays);

}  // namespace bevloc::sim
