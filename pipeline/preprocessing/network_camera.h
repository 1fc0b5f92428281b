// The virtual camera of the network: undistorted, scaled and cropped.
#pragma once

#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Size of one network input image.
inline constexpr int kNetworkWidthPx = 320;
inline constexpr int kNetworkHeightPx = 96;
/// Row of the horizon, close to the top, so that the image contains little sky.
inline constexpr double kNetworkHorizonRow = 14.0;
/// The least focal length: a network image shows at most 90 degrees, enough for six cameras around
/// a vehicle. A lens that sees more would only make everything smaller.
inline constexpr double kLeastNetworkFocalPx = 0.5 * kNetworkWidthPx;

/// How many pixels of the real image fit side by side into one pixel of the network image.
double real_pixels_per_network_pixel(const Intrinsics& real);

/// Has the position and direction of the real camera, without distortion. The image width, or its
/// middle part (kLeastNetworkFocalPx), is scaled to kNetworkWidthPx with square pixels. The rows
/// are shifted so that the horizon of a level vehicle is at kNetworkHorizonRow in the principal
/// column.
CameraModel network_camera(const CameraModel& camera);

Rig network_rig(const Rig& rig);

}  // namespace bevloc
