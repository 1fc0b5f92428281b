// An estimator with the samples and matches of a simulated vehicle.
#pragma once

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pipeline/tracker/pose_estimator.h"
#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc::test {

/// A pose that matches have confirmed for 10 s.
class PoseEstimatorTest : public testing::Test {
 protected:
  PoseEstimatorTest() {
    for (int i = 0; i < 500; ++i) step();
  }

  void step(double gnss_beside_m = 0.0) {
    time_s_ += 0.02;
    vehicle_.drive_to(time_s_);
    estimator_.add(vehicle_.odometry(time_s_));
    if (++steps_ % 5 != 0) return;
    GnssSample gnss = vehicle_.gnss();
    gnss.north_m += gnss_beside_m;
    if (has_gnss_) estimator_.add(gnss);
    if (has_matches_) match_with({});
    estimator_.judge(at_s(time_s_), true);
  }
  void drive(double duration_s, double gnss_beside_m = 0.0) {
    for (int i = 0; i < static_cast<int>(duration_s * 50.0); ++i) step(gnss_beside_m);
  }
  /// Distance of the pose from the true one. It is infinite without a pose.
  double error_m() {
    const auto pose = estimator_.pose_at(at_s(time_s_));
    if (!pose) return std::numeric_limits<double>::infinity();
    return error_of(*pose, vehicle_.drive_to(time_s_)).head<2>().norm();
  }

  /// A match at the true pose but for `offset`, in the vehicle frame.
  MatchResult match_at(const Se2& prior, const Se2& offset) {
    MatchResult match = vehicle_.correction_from(prior);
    match.correction = match.correction * offset;
    match.score = 0.4;
    match.axis_score.setOnes();
    return match;
  }
  TrackerUpdate match_with(const Se2& offset, double yaw_edge_mass = 0.0) {
    const Se2 prior = estimator_.pose_at(at_s(time_s_))->map_from_vehicle;
    MatchResult match = match_at(prior, offset);
    match.edge_mass.z() = yaw_edge_mass;
    return estimator_.add_match(at_s(time_s_), prior, match).update;
  }
  double yaw_sigma_rad() const {
    return std::sqrt(estimator_.tracker().pose_at(at_s(time_s_))->covariance(2, 2));
  }

  SimulatedVehicle vehicle_{{.gnss_position_sigma_m = 1.0,
                             .gnss_yaw_sigma_rad = radians(1.0),
                             .gnss_correlation_s = 40.0},
                            1};
  PoseEstimator estimator_{TrackerParameters()};
  double time_s_ = 0.0;
  int steps_ = 0;
  bool has_gnss_ = true;
  bool has_matches_ = true;
};

}  // namespace bevloc::test
