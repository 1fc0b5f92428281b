// The arbiter: voters that lean to one side.
#include "common/se2.h"
#include "tests/pipeline/tracker/arbiter_fixture.h"

namespace bevloc {
namespace {

using test::ArbiterTest;
using test::innovation;
using test::kYawSigma_rad;

TEST_F(ArbiterTest, FindsInnovationsThatLeanToOneSide) {
  run(100, none_, none_);
  EXPECT_FALSE(arbiter_.odometry_drifts());
  run(60, {0.5, 0.0, 0.0}, none_);  // within the gate, always ahead
  EXPECT_TRUE(arbiter_.odometry_drifts());
}

/// With a yaw rate that has a bias, match and GNSS see the same heading error.
TEST_F(ArbiterTest, HeadingsThatLeanToTheSameSideDoNotExcludeGnss) {
  run(100, none_, none_);
  run(25, {0.0, 0.0, radians(0.18)}, {0.0, 0.0, radians(0.25)});
  EXPECT_TRUE(arbiter_.odometry_drifts());
  EXPECT_TRUE(arbiter_.trusts_gnss());
  arbiter_.forget_drift(now_);
  EXPECT_FALSE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, WheelsThatLeanWithGnssMeanDrift) {
  run(100, none_, none_);
  run(25, none_, {0.0, 0.0, 0.5 * kYawSigma_rad});
  arbiter_.add_odometry(now_, 2.0);
  EXPECT_FALSE(arbiter_.odometry_drifts());
  arbiter_.add_odometry(now_, -4.0);
  EXPECT_FALSE(arbiter_.odometry_drifts()) << "to the other side";
  arbiter_.add_odometry(now_, 4.0);
  EXPECT_TRUE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, WheelsAloneMeanNoDrift) {
  run(100, none_, none_);
  arbiter_.add_odometry(now_, 8.0);
  EXPECT_FALSE(arbiter_.odometry_drifts());
}

/// Match and GNSS lean by 1.7 and 2.2 standard deviations.
TEST_F(ArbiterTest, AThirdVoterThatLeansALittleMakesDrift) {
  run(100, none_, none_);
  run(20, {0.0, 0.0, 0.42 * kYawSigma_rad}, {0.0, 0.0, 0.55 * kYawSigma_rad});
  EXPECT_FALSE(arbiter_.odometry_drifts());
  arbiter_.add_odometry(now_, 0.9);
  EXPECT_FALSE(arbiter_.odometry_drifts());
  arbiter_.add_odometry(now_, 2.4);
  EXPECT_TRUE(arbiter_.odometry_drifts());
}

/// The wheels lean until they have learned the bias. Until then they report the drift only once.
TEST_F(ArbiterTest, WheelsMeanDriftOnceUntilTheyHaveLearnedIt) {
  const Eigen::Vector3d turned(0.0, 0.0, 0.5 * kYawSigma_rad);
  run(25, none_, turned);
  arbiter_.add_odometry(now_, 4.0);
  ASSERT_TRUE(arbiter_.odometry_drifts());
  arbiter_.forget_drift(now_);
  run(25, none_, turned);
  arbiter_.add_odometry(now_, 4.0);
  EXPECT_FALSE(arbiter_.odometry_drifts());
  arbiter_.add_odometry(now_ + std::chrono::seconds(60), 4.0);
  EXPECT_TRUE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, WheelsShowTheEndOfABiasThatTheyHaveShown) {
  const Eigen::Vector3d turned(0.0, 0.0, 0.5 * kYawSigma_rad);
  run(25, none_, turned);
  arbiter_.add_odometry(now_, 4.0);
  arbiter_.forget_drift(now_);
  run(25, none_, -turned);
  arbiter_.add_odometry(now_, 3.5);
  EXPECT_FALSE(arbiter_.odometry_drifts());
  arbiter_.add_odometry(now_, 0.5);
  EXPECT_TRUE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, AMatchThatDoesNotSeeTheHeadingLeavesItsLean) {
  run(30, {0.0, 0.0, 1.5 * kYawSigma_rad}, none_);
  ASSERT_TRUE(arbiter_.odometry_drifts());
  PoseInnovation blind = innovation(none_);
  blind.covariance(2, 2) = 1.0;
  for (int i = 0; i < 30; ++i)
    arbiter_.add_match(now_ += std::chrono::milliseconds(100), blind, true);
  EXPECT_TRUE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, HeadingsThatLeanApartExcludeGnss) {
  run(100, none_, none_);
  run(25, {0.0, 0.0, radians(-0.18)}, {0.0, 0.0, radians(0.25)});
  EXPECT_FALSE(arbiter_.odometry_drifts());
  EXPECT_FALSE(arbiter_.trusts_gnss());
}

TEST_F(ArbiterTest, AMatchWhoseHeadingLeansAwayFromThatOfGnssIsExcluded) {
  EXPECT_TRUE(
      run(15, {0.0, 0.0, 1.5 * kYawSigma_rad}, {0.0, 0.0, -0.5 * kYawSigma_rad}).match_contradicts);
  EXPECT_FALSE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, ExcludesAMatchWhoseHeadingLeansAloneIfTheWheelsShowNoBias) {
  const Eigen::Vector3d match(0.0, 0.0, 1.5 * kYawSigma_rad);
  const Eigen::Vector3d gnss(0.0, 0.0, -0.1 * kYawSigma_rad);
  arbiter_.add_odometry(now_, 0.0);
  EXPECT_TRUE(run(15, match, gnss).match_contradicts);
  arbiter_.reset();
  arbiter_.add_odometry(now_, 3.0);
  EXPECT_FALSE(run(15, match, gnss).match_contradicts) << "the wheels lean too";
  arbiter_.reset();
  EXPECT_FALSE(run(15, match, gnss).match_contradicts) << "the wheels are not known";
}

TEST_F(ArbiterTest, AMatchWhoseHeadingLeansWhileThatOfGnssDoesNotMeansDrift) {
  EXPECT_FALSE(run(30, {0.0, 0.0, 1.5 * kYawSigma_rad}, none_).match_contradicts);
  EXPECT_TRUE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, OneOutlierIsNoDrift) {
  run(100, none_, none_);
  arbiter_.add_match(now_, innovation({5.0, 5.0, 0.1}), false);
  EXPECT_FALSE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, AnExcludedMatchDoesNotSayThatOdometryDrifts) {
  run(20, none_, none_);
  run(30, {0.0, 3.0, 0.0}, none_);
  ASSERT_FALSE(arbiter_.trusts_match());
  EXPECT_FALSE(arbiter_.odometry_drifts());
}

TEST_F(ArbiterTest, ExcludedGnssDoesNotSayThatTheYawRateDrifts) {
  run(20, none_, none_);
  const Eigen::Vector3d match(0.0, 0.0, 0.55 * kYawSigma_rad);
  run(30, match, {0.0, 0.0, radians(10.0)});
  ASSERT_FALSE(arbiter_.trusts_gnss());
  EXPECT_FALSE(arbiter_.odometry_drifts());
}

/// A standing vehicle cannot drift. All its matches have the error of one place.
TEST_F(ArbiterTest, MatchesOfAStandingVehicleDoNotAddUpToALean) {
  PoseInnovation match = innovation({0.0, 0.0, 1.5 * kYawSigma_rad});
  match.repeats = true;
  for (int i = 0; i < 600; ++i) {
    const Verdict verdict = step(match, innovation({0.0, 0.0, -0.1 * kYawSigma_rad}), none_);
    ASSERT_FALSE(arbiter_.odometry_drifts());
    ASSERT_FALSE(verdict.match_contradicts);
  }
}

}  // namespace
}  // namespace bevloc
