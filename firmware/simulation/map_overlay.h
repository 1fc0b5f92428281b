// Draws the HD map over a camera image.
#pragma once

#include <opencv2/core.hpp>

#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"
#include "pipeline/map/map_index.h"

namespace bevloc::firmware {

/// Projects the map's lines within 40 m, in their classes' colours, through the camera (distortion
/// included) into its own full-size BGR image, as they would appear from the given pose.
void draw_map_over_image(const MapIndex& map, const Se2& map_from_vehicle,
                         const CameraModel& camera, cv::Mat& image);

}  // namespace bevloc::firmware
