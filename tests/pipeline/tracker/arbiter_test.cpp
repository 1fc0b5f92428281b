#include "pipeline/tracker/arbiter.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc {
namespace {

using std::chrono::milliseconds;

const double kYawSigma_rad = std::sqrt(2e-5);

PoseInnovation innovation(const Eigen::Vector3d& error) {
  PoseInnovation result;
  result.error = error;
  result.covariance = Eigen::Vector3d(0.09, 0.04, kYawSigma_rad * kYawSigma_rad).asDiagonal();
  result.squared_distance = error.dot(result.covariance.inverse() * error);
  result.unexplained = result.squared_distance;
  return result;
}

/// A pose that is valid, with a match and a GNSS sample every 0.1 s.
class ArbiterTest : public testing::Test {
 protected:
  static constexpr double kGate = 16.27;

  Verdict step(const PoseInnovation& match, const PoseInnovation& gnss,
               const Eigen::Vector3d& gnss_error, PoseStanding standing = PoseStanding::kValid) {
    now_ += milliseconds(100);
    arbiter_.add_match(now_, match, match.squared_distance < kGate);
    arbiter_.add_gnss(now_, gnss, gnss.squared_distance < kGate, gnss_error);
    return arbiter_.judge(now_, standing);
  }

  Verdict run(int samples, const Eigen::Vector3d& match_error, const Eigen::Vector3d& gnss_offset) {
    Verdict verdict;
    for (int i = 0; i < samples; ++i) {
      verdict = step(innovation(match_error), innovation(gnss_offset), none_);
    }
    return verdict;
  }

  /// Adds matches and GNSS samples without innovation, while the error of GNSS is `gnss_error`.
  void run_with_gnss_error(int samples, double gnss_error) {
    for (int i = 0; i < samples; ++i) {
      step(innovation(none_), innovation(none_), {gnss_error, 0.0, 0.0});
    }
  }

  const Eigen::Vector3d none_ = Eigen::Vector3d::Zero();
  Arbiter arbiter_{40.0};
  Time now_{std::chrono::seconds(100)};
};

TEST_F(ArbiterTest, TrustsVotersThatAgree) {
  const Verdict verdict = run(100, none_, none_);
  EXPECT_FALSE(verdict.match_contradicts || verdict.gnss_contradicts ||
               verdict.odometry_contradicts || verdict.undecided);
  EXPECT_TRUE(arbiter_.trusts_match());
  EXPECT_TRUE(arbiter_.trusts_gnss());
}

TEST_F(ArbiterTest, BlamesAMatchThatJumpsFartherThanAnyVehicle) {
  run(20, none_, none_);
  EXPECT_TRUE(run(3, {0.0, 3.0, 0.0}, none_).match_contradicts);
  EXPECT_FALSE(arbiter_.trusts_match());
  EXPECT_FALSE(arbiter_.open_dispute());
}

/// While the match is excluded, the pose becomes so uncertain that the gate accepts 1.5 m.
TEST_F(ArbiterTest, TrustsARightMatchAgainAfterThePoseWasLost) {
  run(20, none_, none_);
  run(10, {0.0, 1.5, 0.0}, none_);
  ASSERT_FALSE(arbiter_.trusts_match());
  PoseInnovation uncertain = innovation(none_);
  uncertain.covariance *= 100.0;
  for (int i = 0; i < 100; ++i) step(uncertain, uncertain, none_, PoseStanding::kLost);
  EXPECT_TRUE(arbiter_.trusts_match());
  EXPECT_FALSE(arbiter_.judge(now_, PoseStanding::kLost).match_contradicts);
}

TEST_F(ArbiterTest, LeavesASlowContradictionToGnss) {
  run(20, none_, none_);
  // The match departs in steps that wheels could explain, and GNSS stays with dead reckoning.
  run(1, {1.0, 0.0, 0.0}, none_);
  Verdict verdict = run(3, {1.5, 0.0, 0.0}, none_);
  ASSERT_TRUE(arbiter_.open_dispute() || verdict.match_contradicts);
  verdict = run(3, {1.5, 0.0, 0.0}, none_);
  EXPECT_TRUE(verdict.match_contradicts);
}

TEST_F(ArbiterTest, BlamesDeadReckoningThatMatchAndGnssContradict) {
  run(20, none_, none_);
  run(1, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0});
  const Verdict verdict = run(6, {2.0, 0.0, 0.0}, {2.0, 0.0, 0.0});
  EXPECT_TRUE(verdict.odometry_contradicts);
  EXPECT_FALSE(verdict.match_contradicts || verdict.gnss_contradicts);
}

TEST_F(ArbiterTest, BlamesGnssThatMatchAndDeadReckoningContradict) {
  run(20, none_, none_);
  const Verdict verdict = run(6, none_, {0.0, 20.0, 0.0});
  EXPECT_TRUE(verdict.gnss_contradicts);
  EXPECT_FALSE(verdict.match_contradicts || verdict.odometry_contradicts);
  EXPECT_FALSE(arbiter_.trusts_gnss());
}

/// Matches that agree, but see nothing along the road, and GNSS that moves away along it.
class BlindMatchTest : public ArbiterTest {
 protected:
  BlindMatchTest() {
    run(20, none_, none_);
    see_nothing_along(10, 0.0);
  }

  Verdict see_nothing_along(int samples, double gnss_along_m) {
    PoseInnovation match = innovation(none_);
    match.covariance(0, 0) = 100.0;
    Verdict verdict;
    for (int i = 0; i < samples; ++i) {
      verdict = step(match, innovation({gnss_along_m, 0.0, 0.0}), none_);
    }
    return verdict;
  }
};

TEST_F(BlindMatchTest, DoesNotExcludeGnssThatIsRefusedAlongTheRoad) {
  see_nothing_along(3, 1.0);
  const Verdict verdict = see_nothing_along(6, 1.4);
  EXPECT_TRUE(verdict.undecided);
  EXPECT_TRUE(arbiter_.trusts_gnss());
  ASSERT_TRUE(arbiter_.open_dispute());
  EXPECT_GT(arbiter_.open_dispute()->x(), 1.0) << "the pose may be where GNSS says";
}

TEST_F(BlindMatchTest, ExcludesGnssThatJumpsAlongTheRoad) {
  EXPECT_TRUE(see_nothing_along(6, 20.0).gnss_contradicts);
  EXPECT_FALSE(arbiter_.open_dispute());
}

TEST_F(BlindMatchTest, DoesNotExcludeGnssThatLeansAlongTheRoad) {
  see_nothing_along(60, 0.5);
  EXPECT_TRUE(arbiter_.trusts_gnss());
  run(60, none_, {0.5, 0.0, 0.0});
  EXPECT_FALSE(arbiter_.trusts_gnss()) << "now the match sees along the road";
}

TEST_F(ArbiterTest, DoesNotDecideBeforeThePoseWasValid) {
  for (int i = 0; i < 5; ++i) {
    now_ += milliseconds(100);
    arbiter_.add_match(now_, innovation({0.0, 3.0, 0.0}), false);
  }
  const Verdict verdict = arbiter_.judge(now_, PoseStanding::kNew);
  EXPECT_TRUE(verdict.undecided);
  EXPECT_FALSE(verdict.match_contradicts);
}

TEST_F(ArbiterTest, ReadmitsAVoterThatAgreesForAWhile) {
  run(20, none_, none_);
  run(3, {0.0, 3.0, 0.0}, none_);
  run(5, none_, none_);
  EXPECT_FALSE(arbiter_.trusts_match());
  run(5, none_, none_);
  EXPECT_TRUE(arbiter_.trusts_match());
}

TEST_F(ArbiterTest, AVoterThatOnlyPassesTheGateStaysExcluded) {
  run(20, none_, none_);
  run(3, {0.0, 3.0, 0.0}, none_);
  run(30, {0.0, 0.7, 0.0}, none_);  // 3.5 standard deviations
  EXPECT_FALSE(arbiter_.trusts_match());
}

TEST_F(ArbiterTest, ReadmitsGnssWhoseErrorHasMovedOnce) {
  run_with_gnss_error(30, 0.0);
  run_with_gnss_error(10, 2.5);
  ASSERT_FALSE(arbiter_.trusts_gnss());
  run_with_gnss_error(10, 2.5);
  EXPECT_FALSE(arbiter_.trusts_gnss());
  run_with_gnss_error(10, 2.5);
  EXPECT_TRUE(arbiter_.trusts_gnss());
  run_with_gnss_error(50, 2.5);
  EXPECT_TRUE(arbiter_.trusts_gnss());
}

/// After a tunnel, GNSS may have another error than before.
TEST_F(ArbiterTest, GnssErrorsMayMoveFartherInALongerTime) {
  run_with_gnss_error(30, 0.0);
  now_ += std::chrono::seconds(60);
  run_with_gnss_error(10, 2.5);
  EXPECT_TRUE(arbiter_.trusts_gnss());
}

TEST_F(ArbiterTest, AMatchWhoseNewErrorExplainsItIsNotFarOff) {
  run(20, none_, none_);
  PoseInnovation match = innovation({0.0, 1.4, 0.0});
  match.unexplained = 15.0;
  arbiter_.add_match(now_ + milliseconds(100), match, false);
  EXPECT_FALSE(arbiter_.open_dispute());
}

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
  for (int i = 0; i < 30; ++i) arbiter_.add_match(now_ += milliseconds(100), blind, true);
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

TEST_F(ArbiterTest, AMatchThatIsFarOffBeginsADisputeAtOnce) {
  run(20, none_, none_);
  now_ += milliseconds(100);
  const PoseInnovation match = innovation({0.0, 1.4, 0.0});
  arbiter_.add_match(now_, match, false);
  ASSERT_TRUE(arbiter_.open_dispute());
  EXPECT_NEAR(arbiter_.open_dispute()->y(), 1.4, 0.1);
}

TEST_F(ArbiterTest, AMatchThatSeesNothingOfTheDisputedAxisLeavesItOpen) {
  run(20, none_, none_);
  now_ += milliseconds(100);
  arbiter_.add_match(now_, innovation({0.0, 1.4, 0.0}), false);
  ASSERT_TRUE(arbiter_.open_dispute());
  PoseInnovation blind = innovation(none_);
  blind.covariance(1, 1) = 100.0;
  arbiter_.add_match(now_ + milliseconds(100), blind, true);
  EXPECT_TRUE(arbiter_.open_dispute());
  EXPECT_EQ(arbiter_.matches_refused_in_a_row(), 1);
  arbiter_.add_match(now_ + milliseconds(200), innovation(none_), true);
  EXPECT_FALSE(arbiter_.open_dispute());
}

TEST_F(ArbiterTest, AnAxisThatTheMatchDoesNotSeeIsNoPartOfTheDispute) {
  run(20, none_, none_);
  PoseInnovation match = innovation({5.0, 1.4, 0.0});
  match.covariance(0, 0) = 400.0;
  arbiter_.add_match(now_ + milliseconds(100), match, false);
  match.unexplained = 49.0;
  arbiter_.add_match(now_ + milliseconds(200), match, false);
  ASSERT_TRUE(arbiter_.open_dispute());
  EXPECT_NEAR(arbiter_.open_dispute()->x(), 0.0, 0.1);
  EXPECT_NEAR(arbiter_.open_dispute()->y(), 1.4, 0.1);
}

TEST_F(ArbiterTest, DecidesNothingWhereGnssCannotTellThePlacesApart) {
  run(20, none_, none_);
  now_ += milliseconds(100);
  Verdict verdict;
  for (int i = 0; i < 10; ++i) {
    now_ += milliseconds(100);
    arbiter_.add_match(now_, innovation({1.0 + 0.1 * i, 0.0, 0.0}), false);
    PoseInnovation gnss = innovation(none_);
    gnss.covariance = Eigen::Vector3d(4.0, 4.0, 1e-3).asDiagonal();
    arbiter_.add_gnss(now_, gnss, true, none_);
    verdict = arbiter_.judge(now_, PoseStanding::kValid);
  }
  EXPECT_TRUE(verdict.undecided);
  EXPECT_FALSE(verdict.match_contradicts || verdict.odometry_contradicts);
}

TEST_F(ArbiterTest, ASmallDisputeOfAValidPoseNeedsNoDecision) {
  run(20, none_, none_);
  for (int i = 0; i < 5; ++i) {
    now_ += milliseconds(100);
    arbiter_.add_match(now_, innovation({0.0, 0.0, radians(0.5)}), false);
  }
  EXPECT_TRUE(arbiter_.open_dispute());
  EXPECT_FALSE(arbiter_.judge(now_, PoseStanding::kValid).undecided);
  EXPECT_TRUE(arbiter_.judge(now_, PoseStanding::kNew).undecided);
}

TEST_F(ArbiterTest, ALostPoseNeedsGnss) {
  run(20, none_, none_);
  run(6, none_, {0.0, 20.0, 0.0});
  ASSERT_FALSE(arbiter_.trusts_gnss());
  EXPECT_FALSE(arbiter_.judge(now_, PoseStanding::kLost).gnss_contradicts);
  EXPECT_TRUE(arbiter_.trusts_gnss());
}

}  // namespace
}  // namespace bevloc
