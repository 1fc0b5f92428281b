// The geometry of one camera at one moment, prepared for the pixel loops.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"
#include "sim/vehicle/stance.h"

namespace bevloc::sim {

/// The rays of all pixels, (x, y, 1) in the camera frame, row by row. They are stored with 16 bits
/// per coordinate, which is accurate to 0.01 pixel. Immutable, and so thread-safe.
class CameraRays {
 public:
  explicit CameraRays(const Intrinsics& intrinsics);

  const Intrinsics& intrinsics() const { return intrinsics_; }
  /// The bounding box of all rays.
  const Eigen::Vector2f& low() const { return low_; }
  const Eigen::Vector2f& high() const { return high_; }

  /// Writes the rays of `count` pixels, starting at pixel number `start`.
  void get(size_t start, int count, float* x, float* y) const;

 private:
  Intrinsics intrinsics_;
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  Eigen::Vector2f high_ = Eigen::Vector2f::Zero();
  Eigen::Vector2f step_ = Eigen::Vector2f::Zero();
  /// Coordinates of the rays in steps of step_ from low_.
  std::vector<uint16_t> x_;
  std::vector<uint16_t> y_;
};

/// Caches the ray tables of recent cameras, because each camera of a rig recurs in every frameset.
/// One thread.
class RayCache {
 public:
  /// The result is valid until kCapacity other cameras have been requested.
  const CameraRays& rays_of(const Intrinsics& intrinsics);

 private:
  static constexpr size_t kCapacity = 12;
  std::vector<std::unique_ptr<CameraRays>> tables_;
  size_t oldest_ = 0;
};

/// Where a camera looks from. `rays` must outlive the view. Heights are above the plane on which
/// the vehicle stands.
struct View {
  const CameraRays* rays = nullptr;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< place of the camera in the map
  Eigen::Matrix3f map_from_camera = Eigen::Matrix3f::Identity();
  /// Position and heading of the vehicle on the ground, for its headlights.
  Eigen::Vector2d vehicle = Eigen::Vector2d::Zero();
  Eigen::Vector2f vehicle_forward = Eigen::Vector2f::UnitX();
  CurvedGround ground;

  int width() const { return rays->intrinsics().width_px; }
  int height() const { return rays->intrinsics().height_px; }
};

/// Computes the camera's true pose from the pose on the ground, the stance and the mounting.
View make_view(const CameraRays& rays, const Se3& vehicle_from_camera, const Se2& map_from_vehicle,
               const Stance& stance);

}  // namespace bevloc::sim
