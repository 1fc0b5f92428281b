// A rig for tests, with the camera positions of a nuScenes car.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

#include "common/se2.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::test {

/// A 640x360 camera that looks in direction `azimuth_rad`, counter-clockwise from forward, and is
/// tilted down by `pitch_down_rad`.
inline CameraModel camera_at(double x_m, double y_m, double z_m, double azimuth_rad,
                             double field_of_view_rad, double pitch_down_rad = 0.0) {
  CameraModel camera;
  Intrinsics& intrinsics = camera.intrinsics;
  intrinsics.width_px = 640;
  intrinsics.height_px = 360;
  intrinsics.fx_px = 320.0 / std::tan(0.5 * field_of_view_rad);
  intrinsics.fy_px = intrinsics.fx_px;
  intrinsics.cx_px = 325.0;
  intrinsics.cy_px = 176.0;
  intrinsics.k1 = -0.03;
  intrinsics.k2 = 0.004;
  intrinsics.p1 = 0.0003;
  intrinsics.p2 = -0.0002;

  Eigen::Matrix3d forward_from_camera;  // camera z -> x, x -> -y, y -> -z
  forward_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  camera.vehicle_from_camera.rotation =
      Eigen::AngleAxisd(azimuth_rad, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(pitch_down_rad, Eigen::Vector3d::UnitY()) * forward_from_camera;
  camera.vehicle_from_camera.translation_m = {x_m, y_m, z_m};
  return camera;
}

inline Rig surround_rig() {
  Rig rig;
  rig.cameras = {camera_at(1.52, 0.49, 1.51, radians(55.2), radians(65.0)),
                 camera_at(1.70, 0.02, 1.51, radians(0.3), radians(65.0)),
                 camera_at(1.55, -0.49, 1.50, radians(-56.4), radians(65.0)),
                 camera_at(1.04, 0.48, 1.56, radians(108.6), radians(65.0)),
                 camera_at(0.03, 0.00, 1.58, radians(179.9), radians(89.4)),
                 camera_at(1.02, -0.48, 1.56, radians(-110.8), radians(65.0))};
  return rig;
}

}  // namespace bevloc::test
