#include "firmware/gnss_monitor.h"

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

GnssSample gnss_off_by(double east_m, double heading_rad = 0.0) {
  GnssSample sample;
  sample.position_m = {east_m, 0.0};
  sample.heading_rad = heading_rad;
  sample.position_sigma_m = 1.0;
  sample.heading_sigma_rad = radians(1.0);
  return sample;
}

TEST(GnssMonitorTest, BelievesAPoseWithinGnssError) {
  GnssMonitor monitor;
  for (int i = 0; i < 1000; ++i) monitor.add(gnss_off_by(2.5, radians(2.5)), TrackedPose());
  EXPECT_FALSE(monitor.contradicts());
}

TEST(GnssMonitorTest, OneWildReadingSaysNothing) {
  GnssMonitor monitor;
  monitor.add(gnss_off_by(15.0), TrackedPose());
  EXPECT_FALSE(monitor.contradicts());
}

TEST(GnssMonitorTest, NoticesAPoseThatStaysOffWithinSeconds) {
  GnssMonitor monitor;
  int readings = 0;
  while (!monitor.contradicts() && readings < 100) {
    monitor.add(gnss_off_by(6.0), TrackedPose());
    ++readings;
  }
  EXPECT_LT(readings, 30);
  EXPECT_GT(readings, 3);
}

TEST(GnssMonitorTest, NoticesAHeadingThatStaysOff) {
  GnssMonitor monitor;
  for (int i = 0; i < 50; ++i) monitor.add(gnss_off_by(0.0, radians(6.0)), TrackedPose());
  EXPECT_TRUE(monitor.contradicts());
  monitor.reset();
  EXPECT_FALSE(monitor.contradicts());
}

}  // namespace
}  // namespace bevloc::firmware
