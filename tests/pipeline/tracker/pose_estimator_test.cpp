#include "pipeline/tracker/pose_estimator.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/pose_estimator_fixture.h"

namespace bevloc {
namespace {

using test::PoseEstimatorTest;

TEST_F(PoseEstimatorTest, AMatchAtTheBorderDoesNotCorrectThePose) {
  const double before_rad = yaw_sigma_rad();
  EXPECT_EQ(match_with({}, 1.0), TrackerUpdate::kAccepted);
  EXPECT_NEAR(yaw_sigma_rad(), before_rad, 0.02 * before_rad);
}

TEST_F(PoseEstimatorTest, ALowScoreMakesTheGateAcceptAMatchAtTheSearchBorder) {
  const Se2 prior = estimator_.pose_at(at_s(time_s_))->map_from_vehicle;
  MatchResult match = match_at(prior, {0.0, 0.0, radians(2.0)});
  match.covariance(2, 2) = square_of(radians(0.3));
  match.edge_mass.z() = 1.0;
  EXPECT_EQ(estimator_.add_match(at_s(time_s_), prior, match).update, TrackerUpdate::kGated);
  match.axis_score.z() = 0.0;
  EXPECT_EQ(estimator_.add_match(at_s(time_s_), prior, match).update, TrackerUpdate::kAccepted);
}

TEST_F(PoseEstimatorTest, GnssThatSendsNothingNoLongerContradicts) {
  for (int i = 0; i < 100; ++i) step(20.0);
  EXPECT_TRUE(estimator_.verdict().gnss_contradicts);
  has_gnss_ = false;
  for (int i = 0; i < 150; ++i) step();
  EXPECT_FALSE(estimator_.verdict().gnss_contradicts);
  has_gnss_ = true;
  for (int i = 0; i < 10; ++i) step(20.0);
  EXPECT_TRUE(estimator_.verdict().gnss_contradicts) << "it is still excluded";
}

TEST_F(PoseEstimatorTest, InvalidSamplesDoNotAffectTheNextOnes) {
  GnssSample bad = vehicle_.gnss();
  bad.time += std::chrono::milliseconds(50);
  bad.east_m = std::nan("");
  EXPECT_EQ(estimator_.add(bad), TrackerUpdate::kNotFinite);
  bad.east_m = 0.0;
  bad.sigma_east_m = bad.sigma_north_m = 0.0;
  EXPECT_EQ(estimator_.add(bad), TrackerUpdate::kImplausible);
  PoseEstimator without_pose{TrackerParameters()};
  without_pose.add(vehicle_.odometry(time_s_));
  EXPECT_EQ(without_pose.add(bad), TrackerUpdate::kImplausible);
  OdometrySample odometry = vehicle_.odometry(time_s_ + 0.01);
  odometry.yaw_rate_radps = std::nan("");
  EXPECT_NE(estimator_.add(odometry), TrackerUpdate::kAccepted);
  for (int i = 0; i < 100; ++i) step();
  EXPECT_EQ(estimator_.add(vehicle_.gnss()), TrackerUpdate::kAccepted);
  EXPECT_FALSE(estimator_.verdict().gnss_contradicts);
}

TEST_F(PoseEstimatorTest, ABadFirstSampleOfOdometryTeachesTheMonitorsNothing) {
  for (const double speed_mps : {1e6, std::numeric_limits<double>::infinity(), std::nan("")}) {
    PoseEstimator fresh{TrackerParameters()};
    EXPECT_NE(fresh.add(OdometrySample{at_s(0.0), speed_mps, 0.0}), TrackerUpdate::kAccepted);
    for (int i = 1; i < 10; ++i) {
      const OdometrySample good{at_s(0.02 * i), 10.0 + 0.01 * i, 0.0};
      EXPECT_EQ(fresh.add(good), TrackerUpdate::kAccepted) << speed_mps << ", " << i;
    }
  }
}

TEST_F(PoseEstimatorTest, AMatchAtTheBorderContradictsAPoseOfAnotherPlace) {
  const Se2 border{0.0, 0.0, radians(2.0)};
  EXPECT_EQ(match_with(border, 1.0), TrackerUpdate::kGated);
  EXPECT_EQ(match_with(border, 1.0), TrackerUpdate::kGated);
  EXPECT_EQ(match_with(border, 1.0), TrackerUpdate::kGated);
  const TrackedPose pose = *estimator_.pose_at(at_s(time_s_));
  EXPECT_GT(std::sqrt(pose.covariance(2, 2)), radians(0.9)) << "covers half the offset";
}

/// A vehicle that has no trusted pose yet, with GNSS `gnss_error_m_` to the left of the true place.
class PoseEstimatorStartTest : public testing::Test {
 protected:
  /// Drives while matches find the place `beside_m` to the left of the true one.
  void drive(double duration_s, double beside_m, double score, double along_score) {
    for (int i = 0; i < static_cast<int>(duration_s * 50.0); ++i) {
      time_s_ += 0.02;
      const Se2 truth = vehicle_.drive_to(time_s_);
      OdometrySample odometry = vehicle_.odometry(time_s_);
      odometry.speed_mps *= speed_factor_;
      estimator_.add(odometry);
      if (i % 5 != 0) continue;
      if (has_gnss_) estimator_.add(gnss_beside(truth));
      if (has_matches_) match_beside(beside_m, score, along_score);
      estimator_.judge(at_s(time_s_), false);
    }
  }

  void match_beside(double beside_m, double score, double along_score) {
    const Se2 prior = estimator_.pose_at(at_s(time_s_))->map_from_vehicle;
    MatchResult match = vehicle_.correction_from(prior);
    match.correction = match.correction * Se2{0.0, beside_m, 0.0};
    match.score = score;
    match.axis_score = {along_score, 0.35, 0.35};
    estimator_.add_match(at_s(time_s_), prior, match);
  }

  GnssSample gnss_beside(const Se2& truth) {
    GnssSample gnss = vehicle_.gnss();
    const Se2 beside = truth * Se2{0.0, gnss_error_m_, 0.0};
    gnss.east_m = beside.x_m;
    gnss.north_m = beside.y_m;
    gnss.sigma_east_m = gnss.sigma_north_m = gnss_sigma_m_;
    gnss.yaw->sigma_rad = radians(1.0);
    return gnss;
  }

  SimulatedVehicle vehicle_{{}, 1};
  PoseEstimator estimator_{TrackerParameters()};
  double gnss_error_m_ = 0.0;
  double gnss_sigma_m_ = 1.2;
  bool has_gnss_ = true;
  bool has_matches_ = true;
  double speed_factor_ = 1.0;  ///< of the wheels
  double time_s_ = 0.0;
};

TEST_F(PoseEstimatorStartTest, GoodMatchesNearGnssConfirmAStart) {
  drive(2.0, 0.0, 0.33, 0.3);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_)));
}

TEST_F(PoseEstimatorStartTest, AnotherLaneThatLooksAlikeAcrossTheRoadConfirmsNoStart) {
  gnss_error_m_ = 2.2;
  for (int second = 0; second < 30; ++second) {
    drive(1.0, 0.0, 0.25, 0.04);
    EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_))) << second;
  }
}

TEST_F(PoseEstimatorStartTest, MatchesOutweighGnssThatClaimsTooSmallASigma) {
  gnss_error_m_ = 2.0;
  gnss_sigma_m_ = 0.1;
  drive(20.0, 0.0, 0.36, 0.33);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_)));
  const Se2 truth = vehicle_.drive_to(time_s_);
  EXPECT_LT(error_of(*estimator_.pose_at(at_s(time_s_)), truth).head<2>().norm(), 0.3);
}

/// A street can look alike after half a turn, and matches would confirm whatever heading the pose
/// starts with.
TEST_F(PoseEstimatorStartTest, AStandingVehicleWithoutAHeadingHasNoPose) {
  for (int i = 0; i < 500; ++i) {
    time_s_ += 0.02;
    estimator_.add(OdometrySample{at_s(time_s_), 0.0, 0.0});
    GnssSample gnss = gnss_beside(vehicle_.drive_to(0.0));
    gnss.time = at_s(time_s_);
    gnss.yaw.reset();
    EXPECT_EQ(estimator_.add(gnss), TrackerUpdate::kNoHeading);
    estimator_.judge(at_s(time_s_), false);
    EXPECT_FALSE(estimator_.pose_at(at_s(time_s_)));
    EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_)));
  }
}

TEST_F(PoseEstimatorStartTest, WheelsThatSlipMakeThePoseBeginAgain) {
  speed_factor_ = 1.15;
  bool contradicts = false;
  for (int i = 0; i < 100; ++i) {
    drive(0.1, 0.0, 0.33, 0.3);
    contradicts = contradicts || estimator_.verdict().odometry_contradicts;
    EXPECT_LT(std::abs(estimator_.tracker().speed_scale_error()), 0.1);
  }
  EXPECT_TRUE(contradicts);
}

TEST_F(PoseEstimatorStartTest, APoseThatIsLostWithoutAContradictionKeepsItsSupport) {
  drive(10.0, 0.0, 0.33, 0.3);
  estimator_.judge(at_s(time_s_), true);
  estimator_.judge(at_s(time_s_), false);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_)));
}

/// A pose that is lost in a tunnel may come back in another lane.
TEST_F(PoseEstimatorStartTest, GnssOfSecondsAgoDoesNotConfirmALostPose) {
  drive(10.0, 0.0, 0.33, 0.3);
  estimator_.judge(at_s(time_s_), true);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_)));
  has_gnss_ = false;
  drive(3.0, 0.0, 0.33, 0.3);
  EXPECT_TRUE(estimator_.pose_at(at_s(time_s_)));
  EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_)));
  has_gnss_ = true;
  drive(0.2, 0.0, 0.33, 0.3);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_)));
}

/// The vehicle may have changed to a lane that looks alike.
TEST_F(PoseEstimatorStartTest, APoseThatNoMatchSawForSecondsNeedsNewSupport) {
  drive(10.0, 0.0, 0.33, 0.3);
  estimator_.judge(at_s(time_s_), true);
  has_matches_ = false;
  drive(3.0, 0.0, 0.33, 0.3);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_))) << "a short loss";
  drive(4.0, 0.0, 0.33, 0.3);
  EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_)));
  has_matches_ = true;
  drive(1.0, 0.0, 0.18, 0.14);
  EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_))) << "matches that say nothing";
  drive(5.0, 0.0, 0.33, 0.3);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_)));
}

TEST_F(PoseEstimatorStartTest, MatchesOutweighGnssThatDrewALostPose) {
  drive(20.0, 0.0, 0.36, 0.33);
  estimator_.judge(at_s(time_s_), true);
  gnss_error_m_ = 2.0;
  gnss_sigma_m_ = 0.1;
  has_matches_ = false;
  drive(30.0, 0.0, 0.36, 0.33);
  has_matches_ = true;
  drive(20.0, 0.0, 0.36, 0.33);
  EXPECT_FALSE(estimator_.verdict().match_contradicts);
  const Se2 truth = vehicle_.drive_to(time_s_);
  EXPECT_LT(error_of(*estimator_.pose_at(at_s(time_s_)), truth).head<2>().norm(), 0.3);
}

/// The vehicle drives on unseen, and may be in another lane when odometry comes back.
TEST_F(PoseEstimatorStartTest, APoseThatIsGoneLosesItsSupport) {
  drive(10.0, 0.0, 0.33, 0.3);
  estimator_.judge(at_s(time_s_), true);
  time_s_ += 10.0;
  ASSERT_FALSE(estimator_.pose_at(at_s(time_s_)));
  estimator_.judge(at_s(time_s_), false);
  drive(0.5, 0.0, 0.18, 0.14);
  EXPECT_TRUE(estimator_.pose_at(at_s(time_s_)));
  EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_))) << "matches that say nothing";
}

/// After seconds without odometry nobody knows where the vehicle points.
TEST_F(PoseEstimatorStartTest, AHeadingThatIsLostNeedsAHeadingOfGnss) {
  drive(10.0, 0.0, 0.33, 0.3);
  estimator_.judge(at_s(time_s_), true);
  time_s_ += 3.0;
  estimator_.judge(at_s(time_s_), true);
  GnssSample gnss = gnss_beside(vehicle_.drive_to(time_s_));
  estimator_.add(vehicle_.odometry(time_s_));
  estimator_.judge(at_s(time_s_), false);
  EXPECT_FALSE(estimator_.pose_at(at_s(time_s_)));
  gnss.yaw.reset();
  EXPECT_EQ(estimator_.add(gnss), TrackerUpdate::kNoHeading);
  gnss.yaw = {0.0, radians(1.0)};
  EXPECT_EQ(estimator_.add(gnss), TrackerUpdate::kAccepted);
}

TEST_F(PoseEstimatorStartTest, APoseThatIsLostBecauseOfImplausibleOdometryNeedsNewSupport) {
  drive(10.0, 0.0, 0.33, 0.3);
  estimator_.judge(at_s(time_s_), true);
  OdometrySample slipping = vehicle_.odometry(time_s_ + 0.02);
  slipping.speed_mps *= 3.0;
  ASSERT_EQ(estimator_.add(slipping), TrackerUpdate::kImplausible);
  estimator_.judge(at_s(time_s_), false);
  EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_)));
}

TEST_F(PoseEstimatorStartTest, ARefusedMatchTakesNothingFromAValidPose) {
  drive(10.0, 0.0, 0.33, 0.3);
  estimator_.judge(at_s(time_s_), true);
  const Se2 prior = estimator_.pose_at(at_s(time_s_))->map_from_vehicle;
  MatchResult match = vehicle_.correction_from(prior);
  match.correction = match.correction * Se2{0.0, 3.5, 0.0};
  match.score = 0.33;
  match.axis_score.setConstant(0.3);
  ASSERT_EQ(estimator_.add_match(at_s(time_s_), prior, match).update, TrackerUpdate::kGated);
  EXPECT_TRUE(estimator_.confirms_start(at_s(time_s_)));
}

TEST_F(PoseEstimatorStartTest, ARefusedMatchTakesTheSupportAway) {
  drive(10.0, 0.0, 0.33, 0.3);
  ASSERT_TRUE(estimator_.confirms_start(at_s(time_s_)));
  drive(0.1, 3.5, 0.33, 0.3);
  EXPECT_FALSE(estimator_.confirms_start(at_s(time_s_)));
}

/// The position of an antenna counts as that of the rear axle would.
TEST(PoseEstimatorAntennaTest, MovesThePositionWithItsOwnYaw) {
  SimulatedVehicle vehicle({}, 1);
  PoseEstimator with_antenna{TrackerParameters()};
  PoseEstimator at_axle{TrackerParameters()};
  const Se2 vehicle_from_antenna{2.5, -0.5, 0.0};
  for (int i = 1; i <= 500; ++i) {
    const double time_s = 0.02 * i;
    const Se2 antenna = vehicle.drive_to(time_s) * vehicle_from_antenna;
    const OdometrySample odometry = vehicle.odometry(time_s);
    with_antenna.add(odometry);
    at_axle.add(odometry);
    if (i % 5 != 0) continue;
    GnssSample gnss = vehicle.gnss();
    gnss.sigma_east_m = gnss.sigma_north_m = 0.5;
    gnss.yaw->sigma_rad = radians(0.5);
    at_axle.add(gnss);
    gnss.east_m = antenna.x_m;
    gnss.north_m = antenna.y_m;
    gnss.antenna = GnssSample::Antenna{vehicle_from_antenna.x_m, vehicle_from_antenna.y_m};
    EXPECT_EQ(with_antenna.add(gnss), TrackerUpdate::kAccepted);
  }
  const Se2 difference = at_axle.pose_at(at_s(10.0))->map_from_vehicle.inverse() *
                         with_antenna.pose_at(at_s(10.0))->map_from_vehicle;
  EXPECT_LT(std::hypot(difference.x_m, difference.y_m), 0.02);
}

}  // namespace
}  // namespace bevloc
