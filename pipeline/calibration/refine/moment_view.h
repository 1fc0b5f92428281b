// A camera of a tilted body at one moment, and how its pixels depend on what is estimated.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "common/time.h"
#include "pipeline/calibration/camera_model.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "pipeline/calibration/refine/camera_adjustment.h"
#include "pipeline/calibration/refine/refinement_sums.h"

namespace bevloc {

/// A pixel of a point on the ground, and its derivatives.
struct PointView {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, kCameraParameters> of_camera;
  Eigen::Matrix<double, 2, kFrameUnknowns> of_frame;
  /// Derivative by the point, along the axes of the map and up.
  Eigen::Matrix<double, 2, 3> of_point;
};

/// The transform from the vehicle frame of the reference pose to the frame of the body.
Se3 body_from_vehicle(const FrameVector& frame_error);

class MomentView {
 public:
  /// Views the road with `change` applied to the rig's camera. `picture_time` is the time stamp of
  /// the picture. Returns nothing if the reference does not cover the time and 20 ms around it.
  static std::optional<MomentView> make(const CameraModel& camera, const CameraAdjustment& change,
                                        const FrameVector& frame_error,
                                        const ReferenceTrajectory& reference, Time picture_time);

  const CameraModel& camera() const { return camera_; }
  /// The camera's place in the map frame.
  Eigen::Vector2d eye() const;

  /// Returns nothing for a point that the lens does not see.
  std::optional<PointView> look_at(const Eigen::Vector2d& map_point) const;

  /// Returns only the pixel that look_at() gives, which is faster.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector2d& map_point) const;

  /// Returns the point on the ground, in the map frame, that a pixel shows, or nothing if the pixel
  /// is above the horizon.
  std::optional<Eigen::Vector2d> ground_at(const Eigen::Vector2d& pixel) const;

 private:
  MomentView() = default;

  CameraModel camera_;
  Se3 camera_from_body_;
  Se3 body_from_vehicle_;
  Se3 vehicle_from_camera_;
  Se2 map_from_vehicle_;
  Se2 vehicle_from_map_;
  Se2 vehicle_from_map_before_;  ///< at a time kAround earlier
  Se2 vehicle_from_map_after_;
};

}  // namespace bevloc
