// Which frames of a recording are one frameset.
#include "drivers/camera/replay/recorded_framesets.h"

#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

TEST(RecordedFramesets, JoinFramesOfTheSameMoment) {
  FrameTimes times;
  const auto at = [](int ms) { return Time(std::chrono::milliseconds(ms)); };
  times[0] = {at(0), at(100), at(200)};
  times[1] = {at(30), at(151)};
  const auto framesets = framesets_of(times);
  ASSERT_EQ(framesets.size(), 3U);
  EXPECT_EQ(framesets[0].present.count(), 2U);
  EXPECT_EQ(framesets[1].present.to_ulong(), 1U);
  EXPECT_EQ(framesets[2].present.count(), 2U) << "49 ms apart";
  EXPECT_EQ(framesets[2].time, at(151));
  EXPECT_EQ(framesets[2].frame[0], 2U);
  EXPECT_EQ(framesets[2].frame[1], 1U);
}

}  // namespace
}  // namespace bevloc::drivers
