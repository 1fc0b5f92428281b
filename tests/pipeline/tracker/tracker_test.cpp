#include "pipeline/tracker/tracker.h"

#include <algorithm>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

constexpr double kOdometryStep_s = 0.02;

/// Drives in steps of one odometry sample; GNSS and corrections at their own rates.
struct Drive {
  int gnss_every = 10;       ///< odometry samples; 0: the first one only
  int correction_every = 0;  ///< 0: never
  std::function<void(double time_s, const Se2& truth)> check = [](double, const Se2&) {};

  void run(Tracker& tracker, SimulatedVehicle& vehicle, double seconds) const {
    const int steps = static_cast<int>(seconds / kOdometryStep_s + 0.5);
    for (int i = 0; i <= steps; ++i) {
      const double time_s = i * kOdometryStep_s;
      const Se2 truth = vehicle.drive_to(time_s);
      EXPECT_EQ(tracker.add_odometry(vehicle.odometry(time_s)), TrackerUpdate::kAccepted);
      if (i == 0 || (gnss_every > 0 && i % gnss_every == 0)) tracker.add_gnss(vehicle.gnss());
      if (correction_every > 0 && i > 0 && i % correction_every == 0) {
        const Se2 prior = tracker.pose_at(at_s(time_s))->map_from_vehicle;
        tracker.add_correction(at_s(time_s), prior, vehicle.correction_from(prior));
      }
      check(time_s, truth);
    }
  }
};

SensorErrors typical_errors() {
  return {.speed_scale = 0.015,
          .yaw_rate_bias_radps = radians(0.25),
          .yaw_rate_sigma_radps = radians(0.1) / std::sqrt(kOdometryStep_s),
          .gnss_position_sigma_m = 1.0,
          .gnss_heading_sigma_rad = radians(1.0),
          .gnss_correlation_s = 15.0,
          .correction_sigma_m = 0.1,
          .correction_yaw_sigma_rad = radians(0.2)};
}

TEST(TrackerTest, FollowsPerfectOdometryExactly) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 1);
  Drive drive{.gnss_every = 0};
  drive.check = [&](double time_s, const Se2& truth) {
    const Eigen::Vector3d error = error_of(*tracker.pose_at(at_s(time_s)), truth);
    EXPECT_LT(error.head<2>().norm(), 0.02) << time_s;
    EXPECT_LT(std::abs(error.z()), radians(0.02)) << time_s;
  };
  drive.run(tracker, vehicle, 30.0);
}

TEST(TrackerTest, LearnsScaleAndBiasFromCorrections) {
  const SensorErrors errors = typical_errors();
  Tracker tracker;
  SimulatedVehicle vehicle(errors, 2);
  Drive drive{.gnss_every = 10, .correction_every = 5};
  Eigen::Vector3d worst = Eigen::Vector3d::Zero();
  drive.check = [&](double time_s, const Se2& truth) {
    if (time_s < 20.0) return;
    worst = worst.cwiseMax(error_of(*tracker.pose_at(at_s(time_s)), truth).cwiseAbs());
  };
  drive.run(tracker, vehicle, 90.0);
  EXPECT_NEAR(tracker.speed_scale_error(), errors.speed_scale, 0.003);
  EXPECT_NEAR(tracker.yaw_rate_bias_radps(), errors.yaw_rate_bias_radps, radians(0.05));
  EXPECT_LT(worst.x(), 0.3);
  EXPECT_LT(worst.y(), 0.3);
  EXPECT_LT(worst.z(), radians(0.5));
  const TrackedPose pose = *tracker.pose_at(at_s(90.0));
  EXPECT_NEAR(pose.speed_mps, SimulatedVehicle::speed_mps(90.0), 0.05);
}

TEST(TrackerTest, IsABoundedPriorOnGnssAlone) {
  double square_sum = 0.0;
  int count = 0;
  Eigen::Vector3d worst = Eigen::Vector3d::Zero();
  for (unsigned seed = 0; seed < 8; ++seed) {
    Tracker tracker;
    SimulatedVehicle vehicle(typical_errors(), 10 + seed);
    Drive drive{.gnss_every = 5};
    drive.check = [&](double time_s, const Se2& truth) {
      if (time_s < 30.0) return;
      const Eigen::Vector3d error = error_of(*tracker.pose_at(at_s(time_s)), truth);
      worst = worst.cwiseMax(error.cwiseAbs());
      square_sum += error.head<2>().squaredNorm() / 2.0;
      ++count;
    };
    drive.run(tracker, vehicle, 90.0);
  }
  // GNSS errs by 1 m and alike for 15 s: odometry cannot average that away, but must not add to it.
  EXPECT_LT(std::sqrt(square_sum / count), 1.2);
  EXPECT_LT(worst.head<2>().maxCoeff(), 3.5);
  EXPECT_LT(worst.z(), radians(3.0));
}

TEST(TrackerTest, IsHonestAboutWhiteErrors) {
  // Where errors are as the filter models them, NEES is chi square with 3 degrees of freedom: the
  // mean of N has a deviation of sqrt(6 / N). Samples 2 s apart are taken as independent; the
  // motion noise of the parameters is more than this vehicle has, hence the low side is wide.
  TrackerParameters parameters;
  parameters.gnss_correlation_s = 0.0;
  parameters.correction_correlation_s = 0.0;
  parameters.motion.longitudinal_m_per_sqrt_m = 0.002;
  parameters.motion.lateral_m_per_sqrt_m = 0.002;
  parameters.motion.speed_scale_per_sqrt_s = 1e-5;
  parameters.motion.yaw_rate_bias_radps_per_sqrt_s = 1e-6;
  SensorErrors errors = typical_errors();
  errors.gnss_correlation_s = 0.0;
  double sum = 0.0;
  int count = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Tracker tracker(parameters);
    SimulatedVehicle vehicle(errors, 100 + seed);
    Drive drive{.gnss_every = 25, .correction_every = 50};
    int step = 0;
    drive.check = [&](double time_s, const Se2& truth) {
      if (++step % 100 != 0) return;
      sum += nees_of(*tracker.pose_at(at_s(time_s)), truth);
      ++count;
    };
    drive.run(tracker, vehicle, 30.0);
  }
  const double deviation = std::sqrt(6.0 / count);
  EXPECT_LT(sum / count, 3.0 + 4.0 * deviation);
  EXPECT_GT(sum / count, 3.0 - 8.0 * deviation);
}

TEST(TrackerTest, IsNotOverconfidentAboutCorrelatedErrors) {
  double sum = 0.0;
  int count = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Tracker tracker;
    SimulatedVehicle vehicle(typical_errors(), 200 + seed);
    Drive drive{.gnss_every = 5};  // 10 Hz, errors alike over 15 s
    int step = 0;
    drive.check = [&](double time_s, const Se2& truth) {
      if (++step % 250 != 0) return;
      sum += nees_of(*tracker.pose_at(at_s(time_s)), truth);
      ++count;
    };
    drive.run(tracker, vehicle, 40.0);
  }
  EXPECT_LT(sum / count, 4.5);
  EXPECT_GT(sum / count, 0.5);
}

/// Two trackers on one drive; corrections reach the second late, after newer odometry and GNSS.
TEST(TrackerTest, TakesADelayedCorrectionAtItsOwnTime) {
  Tracker in_time;
  Tracker late;
  SimulatedVehicle vehicle(typical_errors(), 3);
  struct Pending {
    Time time;
    Se2 prior;
    SolverResult result;
  };
  std::vector<Pending> pending;
  std::vector<TrackerUpdate> verdicts;
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
      verdicts.push_back(in_time.add_correction(at_s(time_s), prior, pending.back().result));
    }
    if (i % 25 == 12 && !pending.empty()) {  // 0.24 s late
      EXPECT_EQ(
          late.add_correction(pending.back().time, pending.back().prior, pending.back().result),
          verdicts.back());
      const TrackedPose expected = *in_time.pose_at(at_s(time_s));
      const TrackedPose actual = *late.pose_at(at_s(time_s));
      EXPECT_LT(error_of(actual, expected.map_from_vehicle).norm(), 1e-6);
      EXPECT_TRUE(actual.covariance.isApprox(expected.covariance, 1e-6));
    }
  }
  EXPECT_GT(std::ranges::count(verdicts, TrackerUpdate::kAccepted), 15);
}

TEST(TrackerTest, TakesACorrectionBetweenTwoSamples) {
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

TEST(TrackerTest, GatesAnOutlierWithoutATrace) {
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 5);
  Drive{.gnss_every = 10, .correction_every = 5}.run(tracker, vehicle, 20.0);
  const TrackedPose before = *tracker.pose_at(at_s(20.0));
  SolverResult outlier = vehicle.correction_from(before.map_from_vehicle);
  outlier.correction = {1.8, 0.9, radians(1.0)};
  EXPECT_EQ(tracker.add_correction(at_s(20.0), before.map_from_vehicle, outlier),
            TrackerUpdate::kGated);
  GnssSample jump = vehicle.gnss();
  jump.position_m += Eigen::Vector2d(30.0, 30.0);
  EXPECT_EQ(tracker.add_gnss(jump), TrackerUpdate::kGated);
  const TrackedPose after = *tracker.pose_at(at_s(20.0));
  EXPECT_EQ(error_of(after, before.map_from_vehicle).norm(), 0.0);
  EXPECT_EQ(after.covariance, before.covariance);
}

TEST(TrackerTest, BelievesWhatComesNextOnceItIsWidened) {
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

/// What a solver says that saw nothing: the middle of its range, with the range's own variance.
Correction nothing_seen() {
  Correction result;
  result.evidence = Evidence::kGood;
  result.covariance = Eigen::Vector3d(1.4, 0.4, 4e-4).asDiagonal();
  result.evidence_share.setZero();
  return result;
}

TEST(TrackerTest, ASearchThatSawNothingConfirmsNothing) {
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
    ASSERT_EQ(with.add_correction(at_s(time_s), prior, nothing_seen()), TrackerUpdate::kAccepted);
  }
  const TrackedPose pose = *with.pose_at(at_s(60.0));
  const TrackedPose expected = *without.pose_at(at_s(60.0));
  EXPECT_LT(error_of(pose, expected.map_from_vehicle).norm(), 0.02);
  EXPECT_LT((pose.covariance - expected.covariance).norm(), 0.01 * expected.covariance.norm());
}

TEST(TrackerTest, AnAxisCountsByWhatWasSeenAlongIt) {
  SensorErrors errors = typical_errors();
  errors.gnss_correlation_s = 0.0;
  const auto variance_after = [&](double share) {
    Tracker tracker;
    SimulatedVehicle vehicle(errors, 8);
    Drive{}.run(tracker, vehicle, 5.0);
    const TrackedPose before = *tracker.pose_at(at_s(5.0));
    Correction result = nothing_seen();
    result.evidence_share.x() = share;
    EXPECT_EQ(tracker.add_correction(at_s(5.0), before.map_from_vehicle, result),
              TrackerUpdate::kAccepted);
    return tracker.pose_at(at_s(5.0))->covariance(0, 0) / before.covariance(0, 0);
  };
  EXPECT_NEAR(variance_after(-0.5), 1.0, 1e-3);
  EXPECT_LT(variance_after(0.5), variance_after(0.1));
  EXPECT_LT(variance_after(1.0), variance_after(0.5));
}

TEST(TrackerTest, KnowsNothingBeforeGnssAndOdometry) {
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

TEST(TrackerTest, StartsFromAGnssSampleThatIsOlderThanOdometry) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 8);
  const GnssSample gnss = vehicle.gnss();
  tracker.add_odometry(vehicle.odometry(0.1));
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kAccepted);
  EXPECT_LT(error_of(*tracker.pose_at(at_s(0.1)), vehicle.drive_to(0.1)).head<2>().norm(), 0.02);
}

TEST(TrackerTest, RefusesWhatIsNotFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 9);
  Drive{}.run(tracker, vehicle, 1.0);
  const TrackedPose before = *tracker.pose_at(at_s(1.0));
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(tracker.add_odometry({at_s(1.02), bad, 0.0}), TrackerUpdate::kNotFinite);
    EXPECT_EQ(tracker.add_odometry({at_s(1.02), 0.0, bad}), TrackerUpdate::kNotFinite);
    for (double GnssSample::*field : {&GnssSample::heading_rad, &GnssSample::position_sigma_m,
                                      &GnssSample::heading_sigma_rad}) {
      GnssSample gnss = vehicle.gnss();
      gnss.*field = bad;
      EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kNotFinite);
    }
    GnssSample gnss = vehicle.gnss();
    gnss.position_m.y() = bad;
    EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kNotFinite);
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

TEST(TrackerTest, RefusesWhatCannotBe) {
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 10);
  Drive{}.run(tracker, vehicle, 1.0);
  EXPECT_EQ(tracker.add_odometry({at_s(1.02), 500.0, 0.0}), TrackerUpdate::kImplausible);
  EXPECT_EQ(tracker.add_odometry({at_s(1.02), 5.0, -30.0}), TrackerUpdate::kImplausible);
  EXPECT_EQ(tracker.add_odometry({at_s(1.00), 5.0, 0.0}), TrackerUpdate::kOutOfOrder);
  EXPECT_EQ(tracker.add_odometry({at_s(0.5), 5.0, 0.0}), TrackerUpdate::kOutOfOrder);
  GnssSample gnss = vehicle.gnss();
  gnss.position_sigma_m = 0.0;
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kImplausible);
  gnss = vehicle.gnss();
  gnss.position_m.x() = 1e9;
  EXPECT_EQ(tracker.add_gnss(gnss), TrackerUpdate::kImplausible);
  SolverResult result = vehicle.correction_from({});
  result.covariance(0, 0) = -1.0;
  EXPECT_EQ(tracker.add_correction(at_s(1.0), {}, result), TrackerUpdate::kImplausible);
  result.evidence = Evidence::kNone;
  EXPECT_EQ(tracker.add_correction(at_s(1.0), {}, result), TrackerUpdate::kNoEvidence);
}

TEST(TrackerTest, AnswersWithinItsHistoryAndNotBeyond) {
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

TEST(TrackerTest, DoubtsMoreTheLongerItPredicts) {
  Tracker tracker;
  SimulatedVehicle vehicle(typical_errors(), 12);
  Drive{}.run(tracker, vehicle, 5.0);
  const Eigen::Matrix3d now = tracker.pose_at(at_s(5.0))->covariance;
  const Eigen::Matrix3d soon = tracker.pose_at(at_s(5.2))->covariance;
  const Eigen::Matrix3d later = tracker.pose_at(at_s(5.5))->covariance;
  EXPECT_GT(soon.trace(), now.trace());
  EXPECT_GT(later.trace(), soon.trace());
}

TEST(TrackerTest, StaysPositiveDefiniteThroughGapsAndStandstill) {
  TrackerParameters parameters;
  parameters.history_capacity = 16;  // far fewer than the samples of the history
  Tracker tracker(parameters);
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform;
  double time_s = 0.0;
  int accepted = 0;
  for (int i = 0; i < 5000; ++i) {
    time_s += uniform(random) < 0.01 ? 3.0 : 0.02;
    tracker.add_odometry({at_s(time_s), i % 500 < 250 ? 0.0 : 20.0, uniform(random) - 0.5});
    if (!tracker.is_initialised()) {
      tracker.add_gnss({at_s(time_s), {0.0, 0.0}, 0.0, 1.0, 0.02});
    }
    SolverResult result;
    result.evidence = Evidence::kGood;
    result.correction = {0.2 * uniform(random), 0.2 * uniform(random), 0.01 * uniform(random)};
    result.covariance = Eigen::Vector3d(1e-4, 1e-8, 1e-10).asDiagonal();
    const auto prior = tracker.pose_at(at_s(time_s - 0.1));
    if (prior) {
      accepted += tracker.add_correction(at_s(time_s - 0.1), prior->map_from_vehicle, result) ==
                          TrackerUpdate::kAccepted
                      ? 1
                      : 0;
    }
    const Eigen::Matrix3d covariance = tracker.pose_at(at_s(time_s))->covariance;
    ASSERT_TRUE(covariance.allFinite());
    ASSERT_EQ(covariance.llt().info(), Eigen::Success) << i;
    ASSERT_LT((covariance - covariance.transpose()).norm(), 1e-12);
  }
  EXPECT_GT(accepted, 100);
}

TEST(TrackerTest, NamesEveryVerdict) {
  EXPECT_EQ(name_of(TrackerUpdate::kGated), "gated");
  EXPECT_EQ(name_of(TrackerUpdate::kNoOdometry), "no odometry");
}

}  // namespace
}  // namespace bevloc
