// Accuracy and consistency of the tracker on simulated drives.
#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

TEST(TrackerAccuracyTest, FollowsPerfectOdometryExactly) {
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

TEST(TrackerAccuracyTest, LearnsScaleAndBiasFromCorrections) {
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

TEST(TrackerAccuracyTest, StaysBoundedWithGnssAlone) {
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
  // The GNSS error of 1 m has a correlation time of 15 s. Odometry cannot average it, but must not
  // add to it.
  EXPECT_LT(std::sqrt(square_sum / count), 1.2);
  EXPECT_LT(worst.head<2>().maxCoeff(), 3.5);
  EXPECT_LT(worst.z(), radians(3.0));
}

TEST(TrackerAccuracyTest, CovarianceIsConsistentForWhiteErrors) {
  // If the errors are as the filter models them, NEES is chi-square with 3 degrees of freedom, and
  // the mean of N samples has a standard deviation of sqrt(6 / N). Samples 2 s apart count as
  // independent. The parameters assume more motion noise than this vehicle has, so the lower bound
  // is wide.
  TrackerParameters parameters;
  parameters.correlation = {.match_m = Eigen::Vector3d::Zero(), .gnss_s = 0.0};
  parameters.motion.longitudinal_m_per_sqrt_m = 0.002;
  parameters.motion.lateral_m_per_sqrt_m = 0.002;
  parameters.motion.yaw_rad_per_sqrt_s = radians(0.1);  // typical_errors()
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

TEST(TrackerAccuracyTest, CovarianceIsNotTooSmallForCorrelatedErrors) {
  double sum = 0.0;
  int count = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Tracker tracker;
    SimulatedVehicle vehicle(typical_errors(), 200 + seed);
    Drive drive{.gnss_every = 5};  // 10 Hz; correlation time 15 s
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

TEST(TrackerAccuracyTest, StaysPositiveDefiniteThroughGapsAndStandstill) {
  TrackerParameters parameters;
  parameters.history_capacity = 16;  // far fewer than the events in history_s
  Tracker tracker(parameters);
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform;
  double time_s = 0.0;
  int accepted = 0;
  for (int i = 0; i < 5000; ++i) {
    time_s += uniform(random) < 0.01 ? 3.0 : 0.02;
    tracker.add_odometry({at_s(time_s), i % 500 < 250 ? 0.0 : 20.0, uniform(random) - 0.5});
    if (!tracker.is_initialised()) {
      tracker.add_gnss({at_s(time_s), 0.0, 0.0, 1.0, 1.0, GnssSample::Yaw{0.0, 0.02}});
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

}  // namespace
}  // namespace bevloc
