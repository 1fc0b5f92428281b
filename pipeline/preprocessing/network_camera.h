// The virtual camera of the network: undistorted, scaled and cropped.
#pragma once

#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Size of one network input image.
inline constexpr int kNetworkWidthPx = 320;
inline constexpr int kNetworkHeightPx = 96;
/// Row of the horizon, close to the top, so that the image contains little sky.
inline constexpr double kNetworkHorizonRow = 14.0;

/// Has the position and direction of the real camera, without distortion. The full image width is
/// scaled to kNetworkWidthPx with square pixels and the same principal column. The rows are shifted
/// so that the horizon of a level vehicle is at kNetworkHorizonRow in the principal column.
CameraModel network_camera(const CameraModel& camera);

Rig network_rig(const Rig& rig);

}  // namespace bevloc
