// Draws the HD map over a camera image.
#pragma once

#include <opencv2/core.hpp>

#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"
#include "pipeline/map/map_index.h"

namespace bevloc::evaluation {

/// Draws the map's lines within 40 m into a camera's full-size BGR image, as the camera (with its
/// distortion) would see them from this pose. Each class has its colour (drawing.h).
void draw_map_over_image(const MapIndex& map, const Se2& map_from_vehicle,
                         const CameraModel& camera, cv::Mat& image);

}  // namespace bevloc::evaluation
