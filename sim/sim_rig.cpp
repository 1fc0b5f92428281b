#include "sim/sim_rig.h"

#include <cmath>

#include <Eigen/Geometry>

#include "common/se2.h"

namespace bevloc::sim {
namespace {

/// One camera of nuScenes scene-0061, with intrinsics for 1600 x 900 pixels.
struct Mounting {
  double fx_px;
  double cx_px;
  double cy_px;
  double x_m;
  double y_m;
  double z_m;
  double azimuth_deg;
  double pitch_down_deg;
};

constexpr std::array<Mounting, kCameraCount> kMountings = {{
    {1272.6, 826.6, 479.8, 1.524, 0.495, 1.509, 55.2, 0.6},     // front_left
    {1266.4, 816.3, 491.5, 1.701, 0.016, 1.511, 0.3, 0.4},      // front
    {1260.8, 808.0, 495.3, 1.551, -0.493, 1.496, -56.4, 0.5},   // front_right
    {1256.7, 792.1, 492.8, 1.036, 0.485, 1.591, 108.6, 0.6},    // back_left
    {809.2, 829.2, 481.8, 0.028, 0.003, 1.579, 179.9, 0.9},     // back
    {1259.5, 807.3, 501.2, 1.015, -0.481, 1.562, -110.8, 0.5},  // back_right
}};

constexpr int kWidthPx = 640;
constexpr int kHeightPx = 360;
constexpr double kScale = 640.0 / 1600.0;

/// The columns are the camera's right, down and forward axes in the vehicle frame.
Eigen::Matrix3d vehicle_from_camera_rotation(double azimuth_rad, double pitch_down_rad) {
  const double ca = std::cos(azimuth_rad);
  const double sa = std::sin(azimuth_rad);
  const double cp = std::cos(pitch_down_rad);
  const double sp = std::sin(pitch_down_rad);
  const Eigen::Vector3d forward(ca * cp, sa * cp, -sp);
  const Eigen::Vector3d right(sa, -ca, 0.0);
  Eigen::Matrix3d rotation;
  rotation << right, forward.cross(right), forward;
  return rotation;
}

CameraModel camera_at(const Mounting& mounting, bool wide) {
  CameraModel camera;
  Intrinsics& k = camera.intrinsics;
  k.width_px = kWidthPx;
  k.height_px = kHeightPx;
  k.fx_px = kScale * mounting.fx_px;
  k.fy_px = kScale * mounting.fx_px;
  // At either size, (0, 0) is the centre of the first pixel.
  k.cx_px = (mounting.cx_px + 0.5) * kScale - 0.5;
  k.cy_px = (mounting.cy_px + 0.5) * kScale - 0.5;
  k.k1 = wide ? -0.10 : -0.06;
  k.k2 = 0.01;
  camera.vehicle_from_camera.rotation =
      vehicle_from_camera_rotation(radians(mounting.azimuth_deg), radians(mounting.pitch_down_deg));
  camera.vehicle_from_camera.translation_m = {mounting.x_m, mounting.y_m, mounting.z_m};
  return camera;
}

}  // namespace

Rig nominal_rig() {
  Rig rig;
  for (size_t i = 0; i < kMountings.size(); ++i) {
    rig.cameras[i] = camera_at(kMountings[i], kCameraNames[i] == "back");
  }
  return rig;
}

}  // namespace bevloc::sim
