// One camera at one moment, as the pixel loops need it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "pipeline/calibration/camera_model.h"
#include "sim/render/renderer.h"

namespace bevloc::sim {

/// The rays of all pixels, (x, y, 1) in the camera frame, row by row. Kept in 16 bits for each
/// coordinate, which is good to a hundredth of a pixel.
class CameraRays {
 public:
  explicit CameraRays(const Intrinsics& intrinsics);

  const Intrinsics& intrinsics() const { return intrinsics_; }
  /// The smallest box around all of them.
  const Eigen::Vector2f& low() const { return low_; }
  const Eigen::Vector2f& high() const { return high_; }

  /// Writes the rays of `count` pixels from pixel number `start` on.
  void get(size_t start, int count, float* x, float* y) const;

 private:
  Intrinsics intrinsics_;
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  Eigen::Vector2f high_ = Eigen::Vector2f::Zero();
  Eigen::Vector2f step_ = Eigen::Vector2f::Zero();
  /// Steps from low_.
  std::vector<uint16_t> x_;
  std::vector<uint16_t> y_;
};

/// The ray tables of the cameras seen last: a rig's cameras come back every frame.
class RayCache {
 public:
  const CameraRays& rays_of(const Intrinsics& intrinsics);

 private:
  static constexpr size_t kCapacity = 12;
  std::vector<std::unique_ptr<CameraRays>> tables_;
  size_t oldest_ = 0;
};

struct View {
  const CameraRays* rays = nullptr;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the camera in the map
  Eigen::Matrix3f map_from_camera = Eigen::Matrix3f::Identity();
  /// The vehicle's place and heading on the ground (for its headlights).
  Eigen::Vector2d vehicle = Eigen::Vector2d::Zero();
  Eigen::Vector2f vehicle_forward = Eigen::Vector2f::UnitX();

  int width() const { return rays->intrinsics().width_px; }
  int height() const { return rays->intrinsics().height_px; }
};

/// The camera's true pose: the pose on the ground, then the body's motion, then the mounting.
View make_view(const CameraRays& rays, const Se3& vehicle_from_camera, const Se2& map_from_vehicle,
               const BodyMotion& body);

}  // namespace bevloc::sim
