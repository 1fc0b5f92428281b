// The undistorted, cropped camera that the network looks through.
#pragma once

#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Size of one network input image.
inline constexpr int kNetworkWidthPx = 320;
inline constexpr int kNetworkHeightPx = 96;
/// Where the horizon is placed: nothing is spent on sky.
inline constexpr double kNetworkHorizonRow = 14.0;

/// Same place and direction as the real camera, no distortion, the full image width scaled to
/// kNetworkWidthPx (square pixels, principal column kept), rows shifted so that the horizon of a
/// level vehicle, at the principal column, is at kNetworkHorizonRow.
CameraModel network_camera(const CameraModel& camera);

Rig network_rig(const Rig& rig);

}  // namespace bevloc
