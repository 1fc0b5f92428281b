// One camera: pinhole with radial-tangential distortion, mounted on the vehicle.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace bevloc {

/// Rigid motion in space, target_from_source: p_target = rotation * p_source + translation.
struct Se3 {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation_m;
  }
  Se3 operator*(const Se3& other) const {
    return {rotation * other.rotation, rotation * other.translation_m + translation_m};
  }
  Se3 inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation_m)}; }
};

/// OpenCV's "plumb bob" model: u = fx * x_d + cx, with x_d the distorted normalised coordinate.
/// Pixel (0, 0) is the CENTRE of the top left pixel.
struct Intrinsics {
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;

  /// Pixel of a point in the camera frame (x right, y down, z forward); nothing for a point at or
  /// behind the camera, or where the distortion polynomial no longer grows with the angle.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_camera) const;

  /// Ray through a pixel, scaled to z = 1 in the camera frame; the exact inverse of project().
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;
};

struct CameraModel {
  Intrinsics intrinsics;
  Se3 vehicle_from_camera;
};

}  // namespace bevloc
