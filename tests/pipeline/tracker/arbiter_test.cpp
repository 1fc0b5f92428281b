// The arbiter: disputes, exclusion and readmission.
#include "common/se2.h"
#include "tests/pipeline/tracker/arbiter_fixture.h"

namespace bevloc {
namespace {

using std::chrono::milliseconds;
using test::ArbiterTest;
using test::innovation;

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

/// A match takes time, so GNSS samples that are newer than its frame come before it.
class LateMatchTest : public ArbiterTest {
 protected:
  LateMatchTest() { run(20, none_, none_); }

  Verdict step_late(const PoseInnovation& match, const PoseInnovation& gnss) {
    const Time frame = now_ + milliseconds(50);
    now_ += milliseconds(100);
    arbiter_.add_gnss(now_, gnss, gnss.squared_distance < kGate, GnssError{none_, yaw_rad_});
    arbiter_.add_match(frame, match, match.squared_distance < kGate);
    return arbiter_.judge(now_, PoseStanding::kValid);
  }
};

/// The offset of an earlier match says nothing about the later dispute.
TEST_F(LateMatchTest, AnEarlierDisputeDoesNotDecideALaterOne) {
  EXPECT_TRUE(step_late(innovation({0.0, -3.0, 0.0}), innovation(none_)).match_contradicts);
  for (int i = 0; i < 40; ++i) step_late(innovation(none_), innovation(none_));
  ASSERT_TRUE(arbiter_.trusts_match());
  now_ += std::chrono::seconds(3);
  PoseInnovation gnss = innovation({0.0, 1.2, 0.0});
  gnss.covariance = Eigen::Vector3d(0.3, 0.3, 1e-4).asDiagonal();
  gnss.squared_distance = 4.8;
  for (int i = 0; i < 12; ++i) {
    const Verdict verdict = step_late(innovation({0.0, 1.2, 0.0}), gnss);
    EXPECT_FALSE(verdict.match_contradicts) << i << ": GNSS is where the match is";
  }
}

TEST_F(LateMatchTest, GnssBetweenFrameAndMatchDecidesToo) {
  now_ += std::chrono::seconds(3);
  const PoseInnovation both = innovation({0.0, 2.0, 0.0});
  step_late(both, both);
  EXPECT_TRUE(step_late(both, both).undecided) << "two samples are too few";
  EXPECT_TRUE(step_late(both, both).odometry_contradicts);
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

TEST_F(BlindMatchTest, GnssThatSendsNothingDisputesNothing) {
  see_nothing_along(3, 1.0);
  ASSERT_TRUE(see_nothing_along(6, 1.4).undecided);
  now_ += std::chrono::seconds(3);
  EXPECT_FALSE(arbiter_.judge(now_, PoseStanding::kValid).undecided);
  EXPECT_FALSE(arbiter_.open_dispute());
  EXPECT_FALSE(see_nothing_along(4, 1.4).undecided) << "the refusals count anew";
  EXPECT_TRUE(see_nothing_along(1, 1.4).undecided);
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

/// The error stays the same in the map while the vehicle turns round within 6 s.
TEST_F(ArbiterTest, GnssErrorsDoNotMoveBecauseTheVehicleTurns) {
  const auto drive = [this](int samples, double turned_rad) {
    for (int i = 0; i < samples; ++i) {
      yaw_rad_ += turned_rad / samples;
      step(innovation(none_), innovation(none_), {1.6, 0.0, 0.0});
    }
  };
  drive(30, 0.0);
  drive(60, radians(180.0));
  drive(20, 0.0);
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
    arbiter_.add_gnss(now_, gnss, true, GnssError{});
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
