#include "pipeline/tracker/gnss_monitor.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

GnssSample gnss_off_by(double east_m, double yaw_rad = 0.0) {
  return {.east_m = east_m,
          .sigma_east_m = 1.0,
          .sigma_north_m = 1.0,
          .yaw = GnssSample::Yaw{yaw_rad, radians(1.0)}};
}

TEST(GnssMonitorTest, AcceptsAPoseWithinTheGnssError) {
  GnssMonitor monitor;
  for (int i = 0; i < 1000; ++i) monitor.add(gnss_off_by(2.5, radians(2.5)), TrackedPose());
  EXPECT_FALSE(monitor.contradicts());
}

TEST(GnssMonitorTest, IgnoresASingleOutlier) {
  GnssMonitor monitor;
  monitor.add(gnss_off_by(15.0), TrackedPose());
  EXPECT_FALSE(monitor.contradicts());
}

TEST(GnssMonitorTest, DetectsALastingPositionErrorWithinSeconds) {
  GnssMonitor monitor;
  int samples = 0;
  while (!monitor.contradicts() && samples < 100) {
    monitor.add(gnss_off_by(6.0), TrackedPose());
    ++samples;
  }
  EXPECT_LT(samples, 30);
  EXPECT_GT(samples, 3);
}

TEST(GnssMonitorTest, IgnoresTheYawOfASampleWithoutOne) {
  GnssSample sample = gnss_off_by(0.0);
  sample.yaw.reset();
  TrackedPose west;
  west.map_from_vehicle.yaw_rad = radians(180.0);
  GnssMonitor monitor;
  for (int i = 0; i < 50; ++i) monitor.add(sample, west);
  EXPECT_FALSE(monitor.contradicts());
}

TEST(GnssMonitorTest, DetectsALastingYawError) {
  GnssMonitor monitor;
  for (int i = 0; i < 50; ++i) monitor.add(gnss_off_by(0.0, radians(6.0)), TrackedPose());
  EXPECT_TRUE(monitor.contradicts());
  monitor.reset();
  EXPECT_FALSE(monitor.contradicts());
}

}  // namespace
}  // namespace bevloc
