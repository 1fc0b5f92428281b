// Camera model: intrinsics of a pinhole or a fisheye with distortion, and extrinsics.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

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

/// The rotation by a vector of angle times axis.
Eigen::Matrix3d rotation_by(const Eigen::Vector3d& vector);

/// kPinhole is OpenCV's "plumb bob" model: u = fx * x_d + cx, where x_d is the distorted normalised
/// coordinate. kFisheye is the model of cv::fisheye: the distance from the principal point grows
/// with the angle t from the optical axis as t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8).
enum class Lens : uint8_t { kPinhole, kFisheye };

/// The intrinsics of a camera. The centre of the top left pixel has the coordinates (0, 0).
struct Intrinsics {
  /// A fisheye is used up to this angle from its axis.
  static constexpr double kWidestFisheye_rad = 80.0 * std::numbers::pi / 180.0;

  Lens lens = Lens::kPinhole;
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;  ///< used by a pinhole only, like p2
  double p2 = 0.0;
  double k3 = 0.0;  ///< used by a fisheye only, like k4
  double k4 = 0.0;

  bool operator==(const Intrinsics&) const = default;

  /// Whether straight lines stay straight.
  bool is_straight() const {
    return lens == Lens::kPinhole && k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0;
  }

  /// Returns the pixel of a point in the camera frame (x right, y down, z forward). Returns nothing
  /// for a point with z <= 0, at an angle where the distorted radius no longer increases with the
  /// angle, or beyond kWidestFisheye_rad.
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
  /// Corners of the part of the image that shows the own vehicle, in pixels; empty if no part does.
  /// The network sees this part as black.
  std::vector<Eigen::Vector2d> own_body_px{};

  bool shows_own_body(const Eigen::Vector2d& pixel) const;
};

/// The same camera with images of another size.
CameraModel resized(const CameraModel& camera, int width_px, int height_px);

}  // namespace bevloc
