#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/tracker/pose_estimator.h"
#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

/// A vehicle that has driven east for a minute, with right matches, and then stands.
class StandstillTest : public testing::Test {
 protected:
  void stop_after_a_minute() {
    run(60.0, 10.0);
    run(3.0, 0.0);
  }

  /// Changes the speed by at most 5 m/s^2.
  void run(double duration_s, double speed_mps) {
    for (const double end_s = time_s_ + duration_s; time_s_ < end_s - 1e-9;) {
      time_s_ += kOdometryStep_s;
      speed_mps_ = std::clamp(speed_mps, speed_mps_ - 0.1, speed_mps_ + 0.1);
      truth_.x_m += speed_mps_ * kOdometryStep_s;
      if (has_odometry_) add_odometry();
      if (++steps_ % 5 == 0) add_poses();
      const auto pose = estimator_.pose_at(at_s(time_s_));
      valid_ = pose && (valid_ || estimator_.confirms_start(at_s(time_s_)));
      estimator_.judge(at_s(time_s_), valid_);
    }
  }

  void add_odometry() {
    const double noise = steps_ % 2 == 0 ? 0.01 : -0.01;  // real sensors never repeat their values
    estimator_.add(OdometrySample{at_s(time_s_), speed_mps_ + noise, yaw_rate_bias_radps_});
  }

  void add_poses() {
    GnssSample gnss{.time = at_s(time_s_), .sigma_east_m = 1.0, .sigma_north_m = 1.0};
    gnss.east_m = truth_.x_m;
    gnss.north_m = gnss_north_m_;
    if (gnss_has_yaw_) gnss.yaw = {0.0, radians(1.0)};
    estimator_.add(gnss);
    const auto pose = estimator_.pose_at(at_s(time_s_));
    if (!pose) return;
    MatchResult match;
    match.evidence = Evidence::kGood;
    match.score = 0.4;
    match.axis_score.setOnes();
    match.correction = correction_between(pose->map_from_vehicle, truth_);
    match.covariance = Eigen::Vector3d(0.1, 0.1, radians(0.2)).cwiseAbs2().asDiagonal();
    estimator_.add_match(at_s(time_s_), pose->map_from_vehicle, match);
  }

  /// Sigma of the pose: (longitudinal m, lateral m, yaw rad).
  Eigen::Vector3d sigma() const {
    return estimator_.pose_at(at_s(time_s_))->covariance.diagonal().cwiseSqrt();
  }

  PoseEstimator estimator_{TrackerParameters()};
  Se2 truth_;
  double time_s_ = 0.0;
  double speed_mps_ = 10.0;
  int steps_ = 0;
  double yaw_rate_bias_radps_ = 0.0;
  double gnss_north_m_ = 0.0;
  bool gnss_has_yaw_ = true;
  bool has_odometry_ = true;
  bool valid_ = false;
};

/// Reflections make GNSS lie off by the same vector as long as the vehicle stands.
TEST_F(StandstillTest, AnErrorOfGnssIsNoOffsetOfTheMap) {
  stop_after_a_minute();
  gnss_north_m_ = 2.0;
  run(1200.0, 0.0);
  EXPECT_TRUE(valid_);
  EXPECT_FALSE(estimator_.verdict().map_contradicts);
  EXPECT_LT(estimator_.map_offset().offset_m().norm(), 0.5);
}

TEST_F(StandstillTest, MatchesCountAgainAfterAGapOfTheOdometry) {
  stop_after_a_minute();
  run(10.0, 0.0);
  const Eigen::Vector3d before = sigma();
  has_odometry_ = false;
  run(5.0, 0.0);
  ASSERT_FALSE(estimator_.pose_at(at_s(time_s_)));
  has_odometry_ = true;
  run(3.0, 0.0);
  EXPECT_TRUE(valid_);
  ASSERT_TRUE(estimator_.pose_at(at_s(time_s_)));
  EXPECT_LT(sigma().x(), 1.5 * before.x());
}

/// GNSS without a heading says nothing about the bias of the yaw rate.
TEST_F(StandstillTest, AKnownBiasOfTheYawRateIsNoTurn) {
  yaw_rate_bias_radps_ = radians(0.6);
  stop_after_a_minute();
  EXPECT_NEAR(estimator_.tracker().yaw_rate_bias_radps(), yaw_rate_bias_radps_, radians(0.1));
  gnss_has_yaw_ = false;
  run(27.0, 0.0);
  EXPECT_TRUE(valid_);
  EXPECT_TRUE(estimator_.tracker().latest_innovation().repeats);
  EXPECT_LT(sigma().z(), radians(0.5));
}

}  // namespace
}  // namespace bevloc
