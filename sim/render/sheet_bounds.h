// Where in the image a sheet can appear.
#pragma once

#include <optional>

#include "sim/render/sheet.h"
#include "sim/render/view.h"

namespace bevloc::sim {

struct PixelBox {
  int left, top, right, bottom;  ///< right and bottom are the last ones inside
};

/// A box of pixels around the sheet's part in view; nothing if there is no such part.
/// `corners_camera`: the four corners in turn, in the camera frame.
std::optional<PixelBox> pixels_of(const std::array<Eigen::Vector3f, 4>& corners_camera,
                                  const CameraRays& rays);

}  // namespace bevloc::sim
