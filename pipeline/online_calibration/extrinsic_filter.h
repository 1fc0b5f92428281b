// Estimates the errors of the cameras' extrinsics from many matches.
#pragma once

#include "pipeline/online_calibration/extrinsic_sums.h"
#include "pipeline/online_calibration/motion_direction.h"

namespace bevloc {

/// A Kalman filter whose state contains the errors of all cameras. The errors of cameras that share
/// cells are correlated, and the pose correlates those of all cameras. One thread. Does not
/// allocate.
class ExtrinsicFilter {
 public:
  /// `rig` gives the axes along which the body's rotation turns each camera.
  explicit ExtrinsicFilter(const Rig& rig);

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
  ExtrinsicErrors heading_ = ExtrinsicErrors::Zero();  ///< mean turn of all cameras, per error
  ExtrinsicErrors errors_ = ExtrinsicErrors::Zero();
  ExtrinsicCovariance covariance_;
};

}  // namespace bevloc
