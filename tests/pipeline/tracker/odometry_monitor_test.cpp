#include "pipeline/tracker/odometry_monitor.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc {
namespace {

Time at_ms(int ms) {
  return Time{std::chrono::milliseconds(ms)};
}

/// Speed and yaw rate of a vehicle in city traffic, with the last digits of real sensors.
OdometrySample sample_at(int ms) {
  const double time_s = 1e-3 * ms;
  return {at_ms(ms), 10.0 + 4.0 * std::sin(time_s) + 0.01 * std::sin(777.0 * time_s),
          0.3 * std::sin(0.7 * time_s) + 1e-3 * std::sin(555.0 * time_s)};
}

TEST(OdometryMonitorTest, AcceptsADrive) {
  OdometryMonitor monitor;
  for (int ms = 0; ms < 60'000; ms += 20) EXPECT_TRUE(monitor.accept(sample_at(ms))) << ms;
}

TEST(OdometryMonitorTest, AcceptsAStandingVehicle) {
  OdometryMonitor monitor;
  for (int ms = 0; ms < 5'000; ms += 20) EXPECT_TRUE(monitor.accept({at_ms(ms), 0.0, 0.0}));
}

TEST(OdometryMonitorTest, RefusesRepeatedValuesWithinAQuarterSecond) {
  OdometryMonitor monitor;
  monitor.accept(sample_at(0));
  OdometrySample stuck = sample_at(20);
  int refused_after_ms = -1;
  for (int ms = 20; ms < 1'000 && refused_after_ms < 0; ms += 20) {
    stuck.time = at_ms(ms);
    if (!monitor.accept(stuck)) refused_after_ms = ms - 20;
  }
  EXPECT_GT(refused_after_ms, 100);
  EXPECT_LE(refused_after_ms, 260);
  EXPECT_TRUE(monitor.accept(sample_at(1'000)));
}

TEST(OdometryMonitorTest, AcceptsRepeatedValuesWithCoarseSteps) {
  OdometryMonitor monitor;
  for (int ms = 0; ms < 60'000; ms += 20) {
    OdometrySample sample = sample_at(ms);
    sample.speed_mps = 0.28 * std::round(sample.speed_mps / 0.28);
    sample.yaw_rate_radps = 0.02 * std::round(sample.yaw_rate_radps / 0.02);
    sample.has_fine_steps = false;
    EXPECT_TRUE(monitor.accept(sample)) << ms;
  }
}

TEST(OdometryMonitorTest, RefusesSpinningAndLockedWheels) {
  for (const double factor : {1.3, 0.3, -1.0}) {
    OdometryMonitor monitor;
    for (int ms = 0; ms < 1'000; ms += 20) monitor.accept(sample_at(ms));
    OdometrySample wrong = sample_at(1'000);
    wrong.speed_mps *= factor;
    EXPECT_FALSE(monitor.accept(wrong)) << factor;
    EXPECT_TRUE(monitor.implausible());
    EXPECT_TRUE(monitor.accept(sample_at(1'020))) << "the next good sample counts again";
  }
}

TEST(OdometryMonitorTest, RefusesAJumpOfTheYawRate) {
  OdometryMonitor monitor;
  for (int ms = 0; ms < 1'000; ms += 20) monitor.accept(sample_at(ms));
  OdometrySample wrong = sample_at(1'000);
  wrong.yaw_rate_radps += radians(160.0);
  EXPECT_FALSE(monitor.accept(wrong));
}

TEST(OdometryMonitorTest, AcceptsALastingChangeInTheEnd) {
  OdometryMonitor monitor;
  for (int ms = 0; ms < 1'000; ms += 20) monitor.accept(sample_at(ms));
  bool accepted = false;
  for (int ms = 1'000; ms < 2'000; ms += 20) {
    OdometrySample faster = sample_at(ms);
    faster.speed_mps += 5.0;
    accepted = monitor.accept(faster);
  }
  EXPECT_TRUE(accepted);
}

TEST(OdometryMonitorTest, RefusesAReversedSpeedUntilTheVehicleHasStood) {
  OdometryMonitor monitor;
  for (int ms = 0; ms < 1'000; ms += 20) monitor.accept(sample_at(ms));
  for (int ms = 1'000; ms < 20'000; ms += 20) {
    OdometrySample reversed = sample_at(ms);
    reversed.speed_mps *= -1.0;
    EXPECT_FALSE(monitor.accept(reversed)) << ms;
  }
  EXPECT_TRUE(monitor.accept({at_ms(20'000), 0.5, 0.001})) << "standing";
  EXPECT_TRUE(monitor.accept({at_ms(20'020), -0.2, 0.002}));
  EXPECT_TRUE(monitor.accept({at_ms(22'000), -2.0, 0.001})) << "in reverse";
}

}  // namespace
}  // namespace bevloc
