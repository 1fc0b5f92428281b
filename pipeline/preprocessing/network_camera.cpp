#include "pipeline/preprocessing/network_camera.h"

#include <algorithm>
#include <cassert>

namespace bevloc {
namespace {

/// y / z of the ray parallel to the ground in the plane x = 0 of the camera.
double horizon_slope(const Se3& vehicle_from_camera) {
  const Eigen::Matrix3d& rotation = vehicle_from_camera.rotation;
  assert(rotation(2, 1) != 0.0 && "a camera that looks straight up or down has no horizon");
  return -rotation(2, 2) / rotation(2, 1);
}

}  // namespace

double real_pixels_per_network_pixel(const Intrinsics& real) {
  return std::min(static_cast<double>(real.width_px) / kNetworkWidthPx,
                  real.fx_px / kLeastNetworkFocalPx);
}

CameraModel network_camera(const CameraModel& camera) {
  const Intrinsics& real = camera.intrinsics;
  const double reduction = real_pixels_per_network_pixel(real);
  const double cut_left_px = 0.5 * (real.width_px / reduction - kNetworkWidthPx);

  CameraModel network;
  network.vehicle_from_camera = camera.vehicle_from_camera;
  network.intrinsics.width_px = kNetworkWidthPx;
  network.intrinsics.height_px = kNetworkHeightPx;
  network.intrinsics.fx_px = real.fx_px / reduction;
  network.intrinsics.fy_px = network.intrinsics.fx_px;
  // Pixel centres are integers, so u + 0.5 scales.
  network.intrinsics.cx_px = (real.cx_px + 0.5) / reduction - cut_left_px - 0.5;
  network.intrinsics.cy_px =
      kNetworkHorizonRow - network.intrinsics.fy_px * horizon_slope(camera.vehicle_from_camera);
  return network;
}

std::optional<Eigen::Vector2d> shown_place(const CameraModel& camera, const Intrinsics& network,
                                           const Eigen::Vector2d& pixel) {
  const Intrinsics& real = camera.intrinsics;
  const auto place = real.project(network.ray(pixel));
  const bool inside = place && place->x() >= -0.5 && place->x() <= real.width_px - 0.5 &&
                      place->y() >= -0.5 && place->y() <= real.height_px - 0.5;
  return inside && !camera.shows_own_body(*place) ? place : std::nullopt;
}

Rig network_rig(const Rig& rig) {
  Rig network;
  for (int i = 0; i < kCameraCount; ++i) network.cameras[i] = network_camera(rig.cameras[i]);
  return network;
}

}  // namespace bevloc
