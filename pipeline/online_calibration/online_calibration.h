// Online calibration: learns the errors of the cameras' extrinsics while driving, and says when a
// camera is not where the calibration says.
#pragma once

#include <optional>

#include "common/cameras.h"
#include "common/result.h"
#include "common/time.h"
#include "pipeline/online_calibration/camera_agreement.h"
#include "pipeline/online_calibration/extrinsic_filter.h"
#include "pipeline/online_calibration/motion_direction.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc {

struct OnlineCalibrationOptions {
  bool enabled = true;
  /// Errors beyond these bounds are a fault of the calibration. The errors that are used stay
  /// within them.
  double max_rotation_rad = radians(0.65);
  double max_translation_m = 0.1;

  bool operator==(const OnlineCalibrationOptions&) const = default;
};

/// One match, and the condition under which it was made.
struct CalibrationObservation {
  MatchedCells cells;
  const MatchResult& match;
  CameraMask cameras;     ///< used in the match
  Time time;              ///< time of the frameset
  bool tracking = false;  ///< the prior came from the tracker, which follows the map
  bool driving = false;
  Se2 map_from_vehicle;  ///< the matched pose
  /// Motion from odometry since the previous frameset until `time`, if known. The comparison with
  /// the matched headings begins again where it is not known, and where the pose is not tracked.
  std::optional<DrivenStep> driven{};
};

/// Learns only while the vehicle drives and tracks, from clear matches near the prior, with all
/// cameras. It judges whether a camera contradicts the map even while other cameras are missing. A
/// pose in the wrong lane looks like errors of the cameras. Such apparent errors differ from place
/// to place, so they average out; the bounds limit the rest.
///
/// One thread. Allocates nothing.
class OnlineCalibration {
 public:
  /// `rig` is the network rig of the calibration.
  OnlineCalibration(const Rig& rig, const BevGrid& grid, const OnlineCalibrationOptions& options);

  /// Starts with an estimate of an earlier drive. It accepts errors that faults() would accept, and
  /// keeps used_errors() within the bounds. Fails, and changes nothing, if an error is beyond its
  /// bound by more than half its sigma, a value is not finite, or the covariance is not positive
  /// definite.
  Status restore(const ExtrinsicErrors& errors, const ExtrinsicCovariance& covariance);

  /// Learns from a match, but at most a few times per second. Returns whether used_errors()
  /// changed.
  bool observe(const CalibrationObservation& observation);

  /// The errors to be applied to the calibration. They follow the estimate in steps, because each
  /// change computes the view table again. While a camera is at fault, they are the errors of the
  /// start, because the faulty camera has pulled the estimates of the others.
  const ExtrinsicErrors& used_errors() const { return used_; }
  const ExtrinsicFilter& filter() const { return filter_; }

  /// The cameras with an error that is beyond its bound by more than half its sigma, or whose
  /// picture contradicts the map while those of others agree with it.
  CameraMask faults() const { return beyond_bounds_ | contradicting(); }
  CameraMask contradicting() const { return agreement_.contradicting(); }

  /// The cameras that are to be left out of matches: the first one or two that were at fault. They
  /// stay in this set. Further cameras stay in use.
  CameraMask left_out() const { return left_out_; }

 private:
  void learn_heading(const CalibrationObservation& observation, bool is_clear);
  bool is_clear(const CalibrationObservation& observation) const;
  void judge_bounds();
  void leave_out_faults();
  /// Returns whether the used errors change.
  bool use_again(const ExtrinsicErrors& errors);
  bool follow_estimate();
  double limit_of(int error) const;
  bool is_beyond(int error, double value, double variance) const;
  ExtrinsicErrors within_bounds(ExtrinsicErrors errors) const;

  OnlineCalibrationOptions options_;
  ExtrinsicSums sums_;
  ExtrinsicFilter filter_;
  MotionDirection direction_;
  ExtrinsicInformation information_;
  ExtrinsicErrors used_ = ExtrinsicErrors::Zero();
  ExtrinsicErrors start_ = ExtrinsicErrors::Zero();  ///< the restored errors, or 0
  double unfollowed_s_ = 0.0;                        ///< learning time since used_ has changed
  std::optional<Time> observed_;  ///< the time of the latest observation that was computed
  CameraAgreement agreement_;
  CameraMask beyond_bounds_;
  CameraMask left_out_;
};

}  // namespace bevloc
