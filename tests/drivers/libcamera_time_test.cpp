#include <gtest/gtest.h>

#include "drivers/camera/libcamera/sensor_time.h"

namespace bevloc::drivers::libcam {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

constexpr Time kNow{hours(5)};
constexpr Duration kSuspended = hours(2);

int64_t nanoseconds_of(Time time) {
  return time.time_since_epoch().count();
}

TEST(SensorTime, BootTimeIsConvertedToSteadyTime) {
  const Time exposed = kNow - milliseconds(30);
  EXPECT_EQ(steady_time(nanoseconds_of(exposed + kSuspended), kNow, kSuspended), exposed);
}

TEST(SensorTime, SteadyTimeIsNotChanged) {
  const Time exposed = kNow - milliseconds(30);
  EXPECT_EQ(steady_time(nanoseconds_of(exposed), kNow, kSuspended), exposed);
}

TEST(SensorTime, WithoutSuspensionBothClocksAgree) {
  const Time exposed = kNow - milliseconds(30);
  EXPECT_EQ(steady_time(nanoseconds_of(exposed), kNow, Duration::zero()), exposed);
}

TEST(SensorTime, ReadoutAndExposureAreSubtractedIfTheReadoutIsGiven) {
  EXPECT_EQ(exposure_start(kNow, milliseconds(8), milliseconds(25)), kNow - milliseconds(33));
  EXPECT_EQ(exposure_start(kNow, milliseconds(8), milliseconds(0)), kNow - milliseconds(8));
  EXPECT_EQ(exposure_start(kNow, milliseconds(8), std::nullopt), kNow);
}

}  // namespace
}  // namespace bevloc::drivers::libcam
