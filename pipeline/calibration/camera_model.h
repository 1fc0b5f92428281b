// Camera model: intrinsics with radial-tangential distortion, and extrinsics.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace bevloc {

/// Rigid transform target_from_source in space: p_target = rotation * p_source + translation_m.
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

/// OpenCV's "plumb bob" model: u = fx * x_d + cx, where x_d is the distorted normalised coordinate.
/// (0, 0) is the centre of the top left pixel.
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

  /// Pixel of a point in the camera frame (x right, y down, z forward). Nothing for a point with
  /// z <= 0, or at an angle where the distorted radius no longer increases with the angle.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_camera) const;

  /// Ray through a pixel in the camera frame, scaled to z = 1: the inverse of project(). A pixel
  /// that no ray reaches gets the widest ray in its direction.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;
};

/// The same lens with images of another size.
Intrinsics resized(const Intrinsics& lens, int width_px, int height_px);

struct CameraModel {
  Intrinsics intrinsics;
  Se3 vehicle_from_camera;
};

}  // namespace bevloc
