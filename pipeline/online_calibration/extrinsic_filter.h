// Estimates the errors of the cameras' extrinsics from many matches.
#pragma once

#include "pipeline/online_calibration/extrinsic_sums.h"
#include "pipeline/online_calibration/motion_direction.h"

namespace bevloc {

/// How large errors are and how fast they change, one sigma.
struct ExtrinsicModel {
  double rotation_rad = radians(0.3);  ///< rotation of one camera about each of its axes
  double translation_m = 0.02;         ///< shift of one camera along each of the vehicle's axes
  /// Rotation of all cameras together about the vehicle's axes. The load turns the body about x and
  /// y.
  Eigen::Vector3d body_rotation_rad{radians(0.2), radians(0.2), radians(0.1)};
  /// Growth after one hour of driving, of each angle and of each length.
  double rotation_per_sqrt_hour_rad = radians(0.2);
  double translation_per_sqrt_hour_m = 0.005;
};

/// A Kalman filter whose state contains the errors of all cameras. The errors of cameras that share
/// cells are correlated, and the pose correlates those of all cameras. One thread. Does not
/// allocate.
class ExtrinsicFilter {
 public:
  /// `rig` gives the axes along which the body's rotation turns each camera.
  ExtrinsicFilter(const Rig& rig, const ExtrinsicModel& model);

  /// Starts with an estimate of an earlier drive. Returns false, and changes nothing, if a value is
  /// not finite or the covariance is not positive definite.
  bool restore(const ExtrinsicErrors& errors, const ExtrinsicCovariance& covariance);

  /// `match` was computed with extrinsics that had the errors `used` applied; `driven` is the time
  /// since the previous update.
  void update(const ExtrinsicInformation& match, const ExtrinsicErrors& used, double driven_s);

  /// `turn` is the angle from the direction of motion to the heading that is matched without
  /// correcting errors. It shows the rotation about the vertical axis that all cameras have in
  /// common. A match alone cannot show this rotation.
  void update_heading(const HeadingTurn& turn);

  /// The angle in radians by which these errors turn the matched heading.
  double turn_by(const ExtrinsicErrors& errors) const { return heading_.dot(errors); }

  const ExtrinsicErrors& errors() const { return errors_; }
  const ExtrinsicCovariance& covariance() const { return covariance_; }

 private:
  ExtrinsicModel model_;
  ExtrinsicErrors heading_ = ExtrinsicErrors::Zero();  ///< mean turn of all cameras, per error
  ExtrinsicErrors errors_ = ExtrinsicErrors::Zero();
  ExtrinsicCovariance covariance_;
};

}  // namespace bevloc
