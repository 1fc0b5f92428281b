#include "pipeline/tracker/match_repetition.h"

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

constexpr MeasuredMotion kDriving{10.0, 0.0};
constexpr MeasuredMotion kStanding{0.0, 0.0};

class MatchRepetitionTest : public testing::Test {
 protected:
  /// The variance that is added to a match at this time.
  Eigen::Vector3d added(double time_s, const MeasuredMotion& motion) {
    PoseMeasurement match;
    match.covariance = Eigen::Vector3d(0.1, 0.2, 0.01).asDiagonal();
    match.uncommon_variance = {0.05, 0.1, 0.005};
    repetition_.discount(at_s(time_s), motion.speed_mps, FilterState().stands(motion), correlation_,
                         match);
    return match.repeated_variance;
  }

  ErrorCorrelation correlation_{.match_m = {5.0, 10.0, 0.0}};
  MatchRepetition repetition_;
};

TEST_F(MatchRepetitionTest, ANearMatchRepeatsTheOneBeforeIt) {
  const Eigen::Vector3d first = added(1.0, kDriving);
  EXPECT_GT(first.minCoeff(), 0.0) << "uncertain matches have larger errors than they state";
  EXPECT_GT(added(1.1, kDriving).y(), 2.0 * first.y());
  repetition_.forget();
  EXPECT_EQ(added(1.2, kDriving), first);
}

TEST_F(MatchRepetitionTest, AMatchCountsMoreTheFartherItIsFromTheLast) {
  const double first = added(1.0, kDriving).y();
  const double after_1_m = added(1.1, kDriving).y();
  const double after_5_m = added(1.6, kDriving).y();
  EXPECT_GT(after_1_m, after_5_m);
  EXPECT_GT(after_5_m, first);
  EXPECT_NEAR(added(61.6, kDriving).y(), first, 1e-9);
}

TEST_F(MatchRepetitionTest, AnAxisWithIndependentErrorsRepeatsNothing) {
  const double first = added(1.0, kDriving).z();
  EXPECT_EQ(added(2.0, kDriving).z(), first);
}

TEST_F(MatchRepetitionTest, TheNoiseOfASlowVehicleIsThatOfTheMatchBefore) {
  const double noise = 0.01;
  const double first = added(1.0, kDriving).z();
  const double after_1_m = added(1.1, kDriving).z() - first;
  const double after_5_cm = added(1.2, {0.5, 0.0}).z() - first;
  EXPECT_LT(after_1_m, 0.02 * noise);
  EXPECT_GT(after_5_cm, 6.0 * noise);
  EXPECT_DOUBLE_EQ(added(1.3, {-0.5, 0.0}).z() - first, after_5_cm) << "also backwards";
}

TEST_F(MatchRepetitionTest, TheFirstMatchOfAStopIsNearTheOneBefore) {
  const double first = added(1.0, {0.5, 0.0}).z();
  EXPECT_GT(added(1.1, kStanding).z() - first, 10.0 * 0.01);
}

TEST_F(MatchRepetitionTest, AStandingVehicleLearnsLittleFromTheSecondMatch) {
  const Eigen::Vector3d first = added(1.0, kStanding);
  EXPECT_GT(added(1.1, kStanding).y(), 10.0 * first.y());
  // At one place each match has the same noise, also on an axis without correlation.
  EXPECT_DOUBLE_EQ(added(1.2, kStanding).z(), first.z() + 4.0 * 0.01);
}

/// A tracker that starts at the origin, with a sample of odometry and one of GNSS.
Tracker started_tracker(double speed_mps) {
  Tracker tracker;
  tracker.add_odometry({at_s(0.0), speed_mps, 0.0});
  GnssSample gnss{.time = at_s(0.0), .sigma_east_m = 1.0, .sigma_north_m = 1.0};
  gnss.yaw = {0.0, radians(1.0)};
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kAccepted);
  return tracker;
}

SolverResult match_with(const Se2& error, const Eigen::Vector3d& sigma) {
  SolverResult match;
  match.evidence = Evidence::kGood;
  match.correction = error;
  match.covariance = sigma.cwiseAbs2().asDiagonal();
  return match;
}

TEST(RepeatedMatches, MatchesOfAStandingVehicleDoNotAddUp) {
  Tracker tracker = started_tracker(0.0);
  // Every match has the same error.
  const SolverResult match = match_with({0.5, 0.3, radians(0.6)}, {0.3, 0.2, radians(0.4)});
  const auto sigmas_after = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      const Time time = at_s(0.1 * i);
      tracker.add_odometry({time, 0.0, 0.0});
      EXPECT_EQ(tracker.add_correction(time, {}, match), TrackerUpdate::kAccepted);
    }
    const TrackedPose pose = *tracker.pose_at(at_s(0.1 * (to - 1)));
    return Eigen::Vector3d(pose.covariance.diagonal().cwiseSqrt());
  };
  const Eigen::Vector3d few = sigmas_after(1, 6);
  const Eigen::Vector3d many = sigmas_after(6, 3000);
  EXPECT_GT((many.array() / few.array()).minCoeff(), 0.9) << few.transpose();
}

// Far from all marks, uncertain matches have the same error of two sigmas for 3 s.
TEST(RepeatedMatches, UncertainMatchesOfOnePlaceDoNotAddUp) {
  constexpr double kSpeed_mps = 5.0;
  const Eigen::Vector3d sigma(0.3, 0.4, radians(0.8));
  Tracker tracker = started_tracker(kSpeed_mps);
  const SolverResult match = match_with({0.0, 2.0 * sigma.y(), 0.0}, sigma);
  for (double time_s = 0.1; time_s < 3.05; time_s += 0.1) {
    tracker.add_odometry({at_s(time_s), kSpeed_mps, 0.0});
    const Se2 truth{kSpeed_mps * time_s, 0.0, 0.0};
    EXPECT_EQ(tracker.add_correction(at_s(time_s), truth, match), TrackerUpdate::kAccepted);
    const TrackedPose pose = *tracker.pose_at(at_s(time_s));
    EXPECT_LT(std::abs(error_of(pose, truth).y()), 2.5 * std::sqrt(pose.covariance(1, 1)))
        << time_s << " s";
  }
}

}  // namespace
}  // namespace bevloc
