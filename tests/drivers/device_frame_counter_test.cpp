#include "drivers/camera/device_frame_counter.h"

#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

TEST(DeviceFrameCounter, BeginsAtZeroWhateverTheDeviceCounts) {
  DeviceFrameCounter counter;
  EXPECT_EQ(counter.arrived(17), 0U);
  EXPECT_EQ(counter.arrived(18), 1U);
  counter.restart();
  EXPECT_EQ(counter.arrived(3), 0U);
  EXPECT_EQ(counter.counters().lost, 0U);
}

TEST(DeviceFrameCounter, AGapCountsAsLost) {
  DeviceFrameCounter counter;
  counter.arrived(0);
  counter.delivered(false);
  EXPECT_EQ(counter.arrived(4), 4U);
  EXPECT_EQ(counter.counters().lost, 3U);
  EXPECT_EQ(counter.counters().no_buffer, 0U);
}

TEST(DeviceFrameCounter, AGapWhileAllBuffersAreHeldCountsAsNoBuffer) {
  DeviceFrameCounter counter;
  counter.arrived(0);
  counter.delivered(true);
  counter.arrived(3);
  counter.delivered(false);
  counter.arrived(5);
  EXPECT_EQ(counter.counters().no_buffer, 2U);
  EXPECT_EQ(counter.counters().lost, 1U);
}

TEST(DeviceFrameCounter, HandlesTheWrapAroundOfTheDevicesCount) {
  DeviceFrameCounter counter;
  counter.arrived(0xFFFFFFFE);
  EXPECT_EQ(counter.arrived(1), 3U);
  EXPECT_EQ(counter.counters().lost, 2U);
}

TEST(DeviceFrameCounter, ADeviceThatBeginsAgainLosesNothing) {
  DeviceFrameCounter counter;
  counter.arrived(500);
  EXPECT_EQ(counter.arrived(0), 1U);
  EXPECT_EQ(counter.arrived(2), 3U);
  EXPECT_EQ(counter.counters().lost, 1U);
}

TEST(DeviceFrameCounter, CountsDamagedFramesSeparately) {
  DeviceFrameCounter counter;
  counter.arrived(0);
  counter.damaged();
  counter.arrived(1);
  counter.delivered(false);
  const CameraCounters counters = counter.counters();
  EXPECT_EQ(counters.damaged, 1U);
  EXPECT_EQ(counters.delivered, 1U);
  EXPECT_EQ(counters.lost, 0U);
}

}  // namespace
}  // namespace bevloc::drivers
