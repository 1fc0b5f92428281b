// Drives an online calibration past a made-up road.
#pragma once

#include "tests/pipeline/online_calibration/demo_cells.h"

namespace bevloc {

inline MatchResult clear_match() {
  MatchResult match;
  match.evidence = Evidence::kGood;
  match.covariance.diagonal() << 0.01, 0.0025, radians(0.1) * radians(0.1);
  return match;
}

/// Drives along the same road. The true extrinsics differ from the nominal ones by `errors`.
class DemoDriver {
 public:
  explicit DemoDriver(const OnlineCalibrationOptions& options = {})
      : calibration_(cells_.rig(), kFeatureGrid, options) {}

  void drive(const ExtrinsicErrors& errors, int framesets, CameraMask blind = {}) {
    cells_.show(errors - calibration_.used_errors(), blind);
    for (int i = 0; i < framesets; ++i) {
      if (observe()) cells_.show(errors - calibration_.used_errors(), blind);
    }
  }

  /// Drives where the cameras see nothing, so that nothing is learned.
  void drive_blank(int framesets) {
    cells_.show_nothing();
    for (int i = 0; i < framesets; ++i) observe();
  }

  const OnlineCalibration& calibration() const { return calibration_; }

  MatchResult match = clear_match();
  CameraMask cameras = CameraMask().set();
  bool tracking = true;
  bool driving = true;
  double heading_against_motion_rad = 0.0;
  double beside_m = 0.0;  ///< the matched positions lie this far beside the path

 private:
  bool observe() {
    const DrivenStep step{time_, time_ + std::chrono::milliseconds(100), {1.0, 0.0, 0.0}};
    time_ = step.to;
    path_ = path_ * step.motion;
    const Se2 matched{path_.x_m, path_.y_m + beside_m, path_.yaw_rad + heading_against_motion_rad};
    return calibration_.observe(
        {cells_.match(), match, cameras, time_, tracking, driving, matched, step});
  }

  DemoCells cells_;
  OnlineCalibration calibration_;
  Time time_{};
  Se2 path_;
};

}  // namespace bevloc
