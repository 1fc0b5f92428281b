#include <gtest/gtest.h>

#include "drivers/camera/libcamera/sensor_time.h"

namespace bevloc::drivers::libcam {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

constexpr Time kNow{hours(5)};
constexpr Duration kSlept = hours(2);

int64_t nanoseconds_of(Time time) {
  return time.time_since_epoch().count();
}

TEST(SensorTime, BootTimeLosesTheTimeSlept) {
  const Time exposed = kNow - milliseconds(30);
  EXPECT_EQ(steady_time(nanoseconds_of(exposed + kSlept), kNow, kSlept), exposed);
}

TEST(SensorTime, SteadyTimeStaysAsItIs) {
  const Time exposed = kNow - milliseconds(30);
  EXPECT_EQ(steady_time(nanoseconds_of(exposed), kNow, kSlept), exposed);
}

TEST(SensorTime, TheTwoAreOneOnAMachineThatNeverSlept) {
  const Time exposed = kNow - milliseconds(30);
  EXPECT_EQ(steady_time(nanoseconds_of(exposed), kNow, Duration::zero()), exposed);
}

}  // namespace
}  // namespace bevloc::drivers::libcam
