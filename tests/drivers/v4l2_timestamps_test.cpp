#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "drivers/camera/v4l2/timestamps.h"

namespace bevloc::drivers::v4l2 {
namespace {

using std::chrono::milliseconds;

constexpr timeval kStamp{12, 345'678};
constexpr Time kStampTime{std::chrono::microseconds(12'345'678)};
constexpr uint32_t kStartOfExposure =
    V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
constexpr uint32_t kEndOfFrame = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;

TEST(V4l2Timestamps, AStampAtStartOfExposureIsNotChanged) {
  const auto rule = stamp_rule(kStartOfExposure, milliseconds(8), milliseconds(20));
  ASSERT_TRUE(rule);
  EXPECT_EQ(exposure_start(kStamp, *rule), kStampTime);
}

TEST(V4l2Timestamps, AReadoutThatIsNotUsedIsTold) {
  EXPECT_TRUE(stamp_rule(kStartOfExposure, milliseconds(8), milliseconds(20))->ignores_readout);
  EXPECT_FALSE(stamp_rule(kStartOfExposure, milliseconds(8), std::nullopt)->ignores_readout);
  EXPECT_FALSE(stamp_rule(kEndOfFrame, milliseconds(8), milliseconds(20))->ignores_readout);
}

TEST(V4l2Timestamps, ReadoutAndExposureAreSubtractedFromAStampAtTheEnd) {
  const auto rule = stamp_rule(kEndOfFrame, milliseconds(8), milliseconds(20));
  ASSERT_TRUE(rule);
  EXPECT_EQ(exposure_start(kStamp, *rule), kStampTime - milliseconds(28));
}

TEST(V4l2Timestamps, AStampAtTheEndNeedsTheReadout) {
  const auto rule = stamp_rule(kEndOfFrame, milliseconds(8), std::nullopt);
  ASSERT_FALSE(rule);
  EXPECT_NE(rule.error().message.find("readout_ms"), std::string::npos);
}

TEST(V4l2Timestamps, OtherClocksAreRefused) {
  EXPECT_FALSE(stamp_rule(V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN, {}, {}));
  EXPECT_FALSE(stamp_rule(V4L2_BUF_FLAG_TIMESTAMP_COPY, {}, {}));
}

}  // namespace
}  // namespace bevloc::drivers::v4l2
