// The virtual camera of the network: undistorted, scaled and cropped.
#pragma once

#include <optional>

#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Size of one network input image.
inline constexpr int kNetworkWidthPx = 320;
inline constexpr int kNetworkHeightPx = 96;
/// Row of the horizon, close to the top, so that the image contains little sky.
inline constexpr double kNetworkHorizonRow = 14.0;
/// The least focal length of a network image, with which it shows 90 degrees. Six cameras then see
/// all around the vehicle. A wider image would show everything smaller.
inline constexpr double kLeastNetworkFocalPx = 0.5 * kNetworkWidthPx;

/// The width of one pixel of the network image, in pixels of the real image.
double real_pixels_per_network_pixel(const Intrinsics& real);

/// The network's camera has the position and direction of the real camera, and no distortion. It
/// shows the whole width of the real image, or its middle 90 degrees if the lens is wider. Its
/// focal length is that of the middle of the lens. It therefore lacks the edges of a fisheye image
/// of less than 114 degrees: if that image covers an angle a, it shows only 2 atan(a / 2). Its
/// pixels are square. The horizon of a level vehicle is at kNetworkHorizonRow in the principal
/// column.
CameraModel network_camera(const CameraModel& camera);

/// The place in the image of `camera` that a pixel of its network image shows. Returns nothing if
/// it lies outside of that image or on the own vehicle: such a pixel is black. `network` must be
/// the intrinsics of network_camera(camera).
std::optional<Eigen::Vector2d> shown_place(const CameraModel& camera, const Intrinsics& network,
                                           const Eigen::Vector2d& pixel);

Rig network_rig(const Rig& rig);

}  // namespace bevloc
