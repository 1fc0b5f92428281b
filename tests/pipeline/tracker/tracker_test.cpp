#include "pipeline/tracker/tracker.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

/// Two trackers on one drive. The second receives each correction late, after newer odometry and
/// GNSS.
TEST(TrackerTest, AppliesADelayedCorrectionAtItsOwnTime) {
  Tracker in_time;
  Tracker late;
  SimulatedVehicle vehicle(typical_errors(), 3);
  struct Pending {
    Time time;
    Se2 prior;
    SolverResult result;
  };
  std::vector<Pending> pending;
  std::vector<TrackerUpdate> updates;
  for (int i = 0; i <= 500; ++i) {
    const double time_s = i * kOdometryStep_s;
    const Se2 truth = vehicle.drive_to(time_s);
    const OdometrySample odometry = vehicle.odometry(time_s);
    in_time.add_odometry(odometry);
    late.add_odometry(odometry);
    if (i % 10 == 0) {
      const GnssSample gnss = vehicle.gnss();
      in_time.add_gnss(gnss);
      late.add_gnss(gnss);
    }
    if (i > 0 && i % 25 == 0) {
      const Se2 prior = truth * Se2{0.5, -0.3, 0.01};
      pending.push_back({at_s(time_s), prior, vehicle.correction_from(prior)});
      updates.push_back(in_time.add_correction(at_s(time_s), prior, pending.back().result));
    }
    if (i % 25 == 12 && !pending.empty()) {  // 0.24 s late
      EXPECT_EQ(
          late.add_correction(pending.back().time, pending.back().prior, pending.back().result),
          updates.back());
      const TrackedPose expected = *in_time.pose_at(at_s(time_s));
      const TrackedPose actual = *late.pose_at(at_s(time_s));
      EXPECT_LT(error_of(actual, expected.map_from_vehicle).norm(), 1e-6);
      EXPECT_TRUE(actual.covariance.isApprox(expected.covariance, 1e-6));
    }
  }
  EXPECT_GT(std::ranges::count(updates, TrackerUpdate::kAccepted), 15);
}

TEST(TrackerTest, AppliesACorrectionBetweenTwoSamples) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 4);
  Drive{.gnss_every = 0}.run(tracker, vehicle, 2.0);
  SimulatedVehicle past({}, 4);
  const double frame_s = 1.913;
  const Se2 truth = past.drive_to(frame_s);
  const Se2 prior = truth * Se2{1.2, -0.7, radians(1.5)};
  EXPECT_EQ(tracker.add_correction(at_s(frame_s), prior, past.correction_from(prior)),
            TrackerUpdate::kAccepted);
  EXPECT_LT(error_of(*tracker.pose_at(at_s(frame_s)), truth).head<2>().norm(), 0.02);
}

TEST(TrackerTest, AGatedOutlierChangesNothing) {
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 5);
  Drive{.gnss_every = 10, .correction_every = 5}.run(tracker, vehicle, 20.0);
  const TrackedPose before = *tracker.pose_at(at_s(20.0));
  SolverResult outlier = vehicle.correction_from(before.map_from_vehicle);
  outlier.correction = {1.8, 0.9, radians(1.0)};
  EXPECT_EQ(tracker.add_correction(at_s(20.0), before.map_from_vehicle, outlier),
            TrackerUpdate::kGated);
  GnssSample jump = vehicle.gnss();
  jump.east_m += 30.0;
  jump.north_m += 30.0;
  EXPECT_EQ(tracker.add_gnss(jump), TrackerUpdate::kGated);
  const TrackedPose after = *tracker.pose_at(at_s(20.0));
  EXPECT_EQ(error_of(after, before.map_from_vehicle).norm(), 0.0);
  EXPECT_EQ(after.covariance, before.covariance);
}

/// Matches whose error is 0.3 m across from one frame to the next.
class NewMatchErrorTest : public testing::Test {
 protected:
  NewMatchErrorTest() {
    Drive{.gnss_every = 10, .correction_every = 5}.run(tracker_, vehicle_, time_s_);
  }

  static SensorErrors errors() {
    SensorErrors errors = typical_errors();
    errors.correction_sigma_m = 0.03;
    return errors;
  }

  /// Drives for 0.1 s and adds the next match.
  TrackerUpdate add(double across_m) {
    for (int step = 0; step < 5; ++step) {
      time_s_ += kOdometryStep_s;
      vehicle_.drive_to(time_s_);
      tracker_.add_odometry(vehicle_.odometry(time_s_));
    }
    const Se2 prior = pose().map_from_vehicle;
    SolverResult match = vehicle_.correction_from(prior);
    match.correction.y_m += across_m;
    return tracker_.add_correction(at_s(time_s_), prior, match);
  }

  TrackedPose pose() const { return *tracker_.pose_at(at_s(time_s_)); }
  /// How far the pose is to the left of the true one.
  double left_m() { return -error_of(pose(), vehicle_.drive_to(time_s_)).y(); }

  Tracker tracker_;
  SimulatedVehicle vehicle_{errors(), 5};
  double time_s_ = 20.0;
};

TEST_F(NewMatchErrorTest, TheThirdMatchIsBelieved) {
  const double variance_before = pose().covariance(1, 1);
  const double left_before_m = left_m();
  EXPECT_EQ(add(0.3), TrackerUpdate::kGated);
  EXPECT_EQ(add(0.3), TrackerUpdate::kGated);
  EXPECT_EQ(add(0.3), TrackerUpdate::kAccepted);
  EXPECT_EQ(add(0.3), TrackerUpdate::kAccepted);
  // Two places, each with the same systematic error: the pose lies between them.
  const double moved_m = left_m() - left_before_m;
  EXPECT_GT(moved_m, 0.03);
  EXPECT_LT(moved_m, 0.2);
  EXPECT_GT(pose().covariance(1, 1), 0.4 * variance_before);
}

TEST_F(NewMatchErrorTest, AMatchThatAgreesBeginsTheCountAgain) {
  EXPECT_EQ(add(0.3), TrackerUpdate::kGated);
  EXPECT_EQ(add(0.3), TrackerUpdate::kGated);
  EXPECT_EQ(add(0.0), TrackerUpdate::kAccepted);
  EXPECT_EQ(add(0.3), TrackerUpdate::kGated);
}

TEST_F(NewMatchErrorTest, ALargeErrorIsRefusedForever) {
  for (int i = 0; i < 10; ++i) EXPECT_EQ(add(1.0), TrackerUpdate::kGated);
  EXPECT_GT(tracker_.latest_innovation().unexplained, tracker_.parameters().gate_squared_distance);
}

TEST(TrackerTest, AcceptsTheNextMeasurementAfterWiden) {
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 6);
  Drive{.gnss_every = 10, .correction_every = 5}.run(tracker, vehicle, 20.0);
  const Se2 prior = tracker.pose_at(at_s(20.0))->map_from_vehicle;
  SolverResult far = vehicle.correction_from(prior);
  far.correction = {1.8, 0.9, radians(1.0)};
  ASSERT_EQ(tracker.add_correction(at_s(20.0), prior, far), TrackerUpdate::kGated);
  tracker.widen();
  EXPECT_GT(tracker.pose_at(at_s(20.0))->covariance(0, 0), 8.0);
  EXPECT_EQ(tracker.add_correction(at_s(20.0), prior, far), TrackerUpdate::kAccepted);
  const Eigen::Vector3d error = error_of(*tracker.pose_at(at_s(20.0)), prior * far.correction);
  EXPECT_LT(error.head<2>().norm(), 0.05);
}

/// The result of a solver without evidence: the middle of its range, with the variance of the
/// range.
MatchResult no_evidence() {
  MatchResult result;
  result.evidence = Evidence::kGood;
  result.covariance = Eigen::Vector3d(1.4, 0.4, 4e-4).asDiagonal();
  result.evidence_share.setZero();
  return result;
}

TEST(TrackerTest, ASearchWithoutEvidenceConfirmsNothing) {
  const SensorErrors errors = typical_errors();
  Tracker with;
  Tracker without;
  SimulatedVehicle vehicle(errors, 7);
  for (int i = 0; i <= 3000; ++i) {
    const double time_s = i * kOdometryStep_s;
    vehicle.drive_to(time_s);
    const OdometrySample odometry = vehicle.odometry(time_s);
    for (Tracker* tracker : {&with, &without}) tracker->add_odometry(odometry);
    if (i % 10 != 0) continue;
    const GnssSample gnss = vehicle.gnss();
    for (Tracker* tracker : {&with, &without}) tracker->add_gnss(gnss);
    if (i == 0) continue;
    const Se2 prior = with.pose_at(at_s(time_s))->map_from_vehicle;
    ASSERT_EQ(with.add_correction(at_s(time_s), prior, no_evidence()), TrackerUpdate::kAccepted);
  }
  const TrackedPose pose = *with.pose_at(at_s(60.0));
  const TrackedPose expected = *without.pose_at(at_s(60.0));
  EXPECT_LT(error_of(pose, expected.map_from_vehicle).norm(), 0.02);
  EXPECT_LT((pose.covariance - expected.covariance).norm(), 0.01 * expected.covariance.norm());
}

TEST(TrackerTest, WeighsEachAxisByItsEvidence) {
  SensorErrors errors = typical_errors();
  errors.gnss_correlation_s = 0.0;
  const auto variance_after = [&](double share) {
    Tracker tracker;
    SimulatedVehicle vehicle(errors, 8);
    Drive{}.run(tracker, vehicle, 5.0);
    const TrackedPose before = *tracker.pose_at(at_s(5.0));
    MatchResult result = no_evidence();
    result.evidence_share.x() = share;
    EXPECT_EQ(tracker.add_correction(at_s(5.0), before.map_from_vehicle, result),
              TrackerUpdate::kAccepted);
    return tracker.pose_at(at_s(5.0))->covariance(0, 0) / before.covariance(0, 0);
  };
  EXPECT_NEAR(variance_after(-0.5), 1.0, 1e-3);
  EXPECT_LT(variance_after(0.5), variance_after(0.1));
  EXPECT_LT(variance_after(1.0), variance_after(0.5));
}

TEST(TrackerTest, HasNoPoseBeforeGnssAndOdometry) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 7);
  EXPECT_EQ(tracker.add_gnss(vehicle.gnss()), TrackerUpdate::kNoOdometry);
  EXPECT_FALSE(tracker.pose_at(at_s(0.0)));
  EXPECT_EQ(tracker.add_odometry(vehicle.odometry(0.0)), TrackerUpdate::kAccepted);
  EXPECT_FALSE(tracker.pose_at(at_s(0.0)));
  EXPECT_EQ(tracker.add_correction(at_s(0.0), {}, vehicle.correction_from({})),
            TrackerUpdate::kNotInitialised);
  EXPECT_EQ(tracker.add_gnss(vehicle.gnss()), TrackerUpdate::kAccepted);
  EXPECT_TRUE(tracker.pose_at(at_s(0.0)));
  tracker.reset();
  EXPECT_FALSE(tracker.pose_at(at_s(0.0)));
  EXPECT_FALSE(tracker.is_initialised());
}

TEST(TrackerTest, InitialisesFromAGnssSampleOlderThanOdometry) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 8);
  const GnssSample gnss = vehicle.gnss();
  tracker.add_odometry(vehicle.odometry(0.1));
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kAccepted);
  EXPECT_LT(error_of(*tracker.pose_at(at_s(0.1)), vehicle.drive_to(0.1)).head<2>().norm(), 0.02);
}

TEST(TrackerTest, RefusesValuesThatAreNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 9);
  Drive{}.run(tracker, vehicle, 1.0);
  const TrackedPose before = *tracker.pose_at(at_s(1.0));
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(tracker.add_odometry({at_s(1.02), bad, 0.0}), TrackerUpdate::kNotFinite);
    EXPECT_EQ(tracker.add_odometry({at_s(1.02), 0.0, bad}), TrackerUpdate::kNotFinite);
    for (double GnssSample::*field : {&GnssSample::east_m, &GnssSample::north_m,
                                      &GnssSample::sigma_east_m, &GnssSample::sigma_north_m}) {
      GnssSample gnss = vehicle.gnss();
      gnss.*field = bad;
      EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kNotFinite);
    }
    for (double GnssSample::Yaw::*field :
         {&GnssSample::Yaw::yaw_rad, &GnssSample::Yaw::sigma_rad}) {
      GnssSample gnss = vehicle.gnss();
      (*gnss.yaw).*field = bad;
      EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kNotFinite);
    }
    SolverResult result = vehicle.correction_from(before.map_from_vehicle);
    result.correction.yaw_rad = bad;
    EXPECT_EQ(tracker.add_correction(at_s(1.0), before.map_from_vehicle, result),
              TrackerUpdate::kNotFinite);
    result = vehicle.correction_from(before.map_from_vehicle);
    result.covariance(1, 1) = bad;
    EXPECT_EQ(tracker.add_correction(at_s(1.0), before.map_from_vehicle, result),
              TrackerUpdate::kNotFinite);
    EXPECT_EQ(tracker.add_correction(at_s(1.0), {bad, 0.0, 0.0}, vehicle.correction_from({})),
              TrackerUpdate::kNotFinite);
  }
  const TrackedPose after = *tracker.pose_at(at_s(1.0));
  EXPECT_EQ(after.covariance, before.covariance);
  EXPECT_EQ(after.map_from_vehicle.x_m, before.map_from_vehicle.x_m);
}

TEST(TrackerTest, RefusesImplausibleValues) {
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 10);
  Drive{}.run(tracker, vehicle, 1.0);
  EXPECT_EQ(tracker.add_odometry({at_s(1.02), 500.0, 0.0}), TrackerUpdate::kImplausible);
  EXPECT_EQ(tracker.add_odometry({at_s(1.02), 5.0, -30.0}), TrackerUpdate::kImplausible);
  EXPECT_EQ(tracker.add_odometry({at_s(1.00), 5.0, 0.0}), TrackerUpdate::kOutOfOrder);
  EXPECT_EQ(tracker.add_odometry({at_s(0.5), 5.0, 0.0}), TrackerUpdate::kOutOfOrder);
  GnssSample gnss = vehicle.gnss();
  gnss.sigma_east_m = gnss.sigma_north_m = 0.0;
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kImplausible);
  gnss = vehicle.gnss();
  gnss.east_m = 1e9;
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kImplausible);
  SolverResult result = vehicle.correction_from({});
  result.covariance(0, 0) = -1.0;
  EXPECT_EQ(tracker.add_correction(at_s(1.0), {}, result), TrackerUpdate::kImplausible);
  result.evidence = Evidence::kNone;
  EXPECT_EQ(tracker.add_correction(at_s(1.0), {}, result), TrackerUpdate::kNoEvidence);
}

TEST(TrackerTest, HasPosesWithinItsHistoryOnly) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 11);
  Drive{.gnss_every = 0}.run(tracker, vehicle, 5.0);
  SimulatedVehicle past({}, 11);
  for (const double time_s : {3.1, 3.7131, 4.999, 5.0, 5.02, 5.1}) {
    const auto pose = tracker.pose_at(at_s(time_s));
    ASSERT_TRUE(pose) << time_s;
    EXPECT_EQ(pose->time, at_s(time_s));
    EXPECT_LT(error_of(*pose, past.drive_to(time_s)).head<2>().norm(), 0.03) << time_s;
  }
  EXPECT_FALSE(tracker.pose_at(at_s(2.5)));
  EXPECT_FALSE(tracker.pose_at(at_s(5.6))) << "odometry is too old";
  EXPECT_EQ(tracker.add_correction(at_s(1.0), {}, past.correction_from({})),
            TrackerUpdate::kTooOld);
  EXPECT_EQ(tracker.add_correction(at_s(5.6), {}, past.correction_from({})),
            TrackerUpdate::kNoOdometry);
}

TEST(TrackerTest, RefusesWhatAFullHistoryHasNoRoomFor) {
  TrackerParameters small;
  small.history_capacity = 3;
  Tracker tracker(small);
  GnssSample gnss{.time = at_s(0.0), .sigma_east_m = 0.5, .sigma_north_m = 0.5};
  gnss.yaw = {0.2, radians(0.5)};
  tracker.add_odometry({at_s(0.0), 5.0, 0.0});
  ASSERT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kAccepted);
  for (const double time_s : {0.02, 0.04}) tracker.add_odometry({at_s(time_s), 5.0, 0.0});
  gnss.time = at_s(0.01);
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kTooOld);
  gnss.time = at_s(0.03);
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kAccepted);
}

TEST(TrackerTest, CovarianceGrowsWithThePrediction) {
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 12);
  Drive{}.run(tracker, vehicle, 5.0);
  const Eigen::Matrix3d now = tracker.pose_at(at_s(5.0))->covariance;
  const Eigen::Matrix3d soon = tracker.pose_at(at_s(5.2))->covariance;
  const Eigen::Matrix3d later = tracker.pose_at(at_s(5.5))->covariance;
  EXPECT_GT(soon.trace(), now.trace());
  EXPECT_GT(later.trace(), soon.trace());
}

TEST(TrackerTest, AStandingVehicleKeepsItsHeading) {
  Tracker tracker;
  const double bias_radps = radians(0.3);
  tracker.add_odometry({at_s(0.0), 0.0, bias_radps});
  GnssSample gnss{.time = at_s(0.0), .sigma_east_m = 0.5, .sigma_north_m = 0.5};
  gnss.yaw = {0.2, radians(0.5)};
  ASSERT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kAccepted);
  const TrackedPose before = *tracker.pose_at(at_s(0.0));
  for (int i = 1; i <= 15000; ++i) tracker.add_odometry({at_s(0.02 * i), 0.05, bias_radps});
  const TrackedPose after = *tracker.pose_at(at_s(300.0));
  EXPECT_NEAR(after.map_from_vehicle.yaw_rad, before.map_from_vehicle.yaw_rad, radians(0.01));
  EXPECT_NEAR(std::sqrt(after.covariance(2, 2)), std::sqrt(before.covariance(2, 2)), radians(0.01));
  // A yaw rate beyond any bias is a turn.
  tracker.add_odometry({at_s(300.02), 0.05, radians(20.0)});
  tracker.add_odometry({at_s(300.52), 0.05, radians(20.0)});
  EXPECT_GT(tracker.pose_at(at_s(300.52))->map_from_vehicle.yaw_rad, 0.2 + radians(8.0));
}

TEST(TrackerTest, AddsSamplesOfEitherKind) {
  SimulatedVehicle vehicle(typical_errors(), 14);
  Tracker by_kind;
  Tracker by_variant;
  const OdometrySample odometry = vehicle.odometry(0.0);
  const GnssSample gnss = vehicle.gnss();
  EXPECT_EQ(by_variant.add(VehicleSample(odometry)), by_kind.add_odometry(odometry));
  EXPECT_EQ(by_variant.add(VehicleSample(gnss)), by_kind.add_gnss(gnss));
  const TrackedPose pose = *by_variant.pose_at(at_s(0.1));
  const TrackedPose expected = *by_kind.pose_at(at_s(0.1));
  EXPECT_EQ(error_of(pose, expected.map_from_vehicle).norm(), 0.0);
  EXPECT_EQ(pose.covariance, expected.covariance);
}

TEST(TrackerTest, StartsWithTheLargerGnssSigmaAndAKnownYaw) {
  Tracker tracker;
  tracker.add_odometry({.time = at_s(0.0)});
  GnssSample gnss{.time = at_s(0.0), .sigma_east_m = 0.5, .sigma_north_m = 2.0};
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kNoHeading);
  EXPECT_FALSE(tracker.pose_at(at_s(0.0)));
  gnss.yaw = {0.3, 0.1};
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kAccepted);
  const Eigen::Matrix3d covariance = tracker.pose_at(at_s(0.0))->covariance;
  EXPECT_DOUBLE_EQ(covariance(0, 0), 4.0);
  EXPECT_DOUBLE_EQ(covariance(1, 1), 4.0);
  EXPECT_DOUBLE_EQ(covariance(2, 2), 0.01);
}

TEST(TrackerTest, NamesEveryUpdate) {
  EXPECT_EQ(name_of(TrackerUpdate::kGated), "gated");
  EXPECT_EQ(name_of(TrackerUpdate::kNoOdometry), "no odometry");
}

}  // namespace
}  // namespace bevloc
