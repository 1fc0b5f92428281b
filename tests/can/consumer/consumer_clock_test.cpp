// Reads the capture time in UTC as a consumer does (can/consumer/bevloc.hpp).
#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/consumer/bevloc.hpp"
#include "can/publisher/pose_publisher.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(ConsumerClockTest, KnowsTheCaptureTimeInUtcOfBothVariants) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    MockWire wire;
    const auto sender = wire.connect();
    const auto reader = wire.connect();
    PosePublisher publisher(*sender,
                            {.map_origin = test::kOrigin, .format = format, .sends_clock = true});
    consumer::Receiver receiver({});
    const microseconds now(1'000'000);
    const auto publish = [&](const ClockReport& clock, Duration later) {
      PoseReport report = test::tracking_report(test::kNow + later);
      report.clock = clock;
      publisher.publish(report, test::kNow + later);
      while (const auto received = reader->receive()) {
        receiver.receive(received->frame.id, received->frame.payload(), now);
      }
      return std::chrono::floor<microseconds>(report.capture_time->time_since_epoch());
    };
    const microseconds offset(1'795'472'500'123'456);
    publish({}, Duration::zero());
    EXPECT_FALSE(receiver.capture_utc_us(now)) << "free running";
    const microseconds capture =
        publish({.source = TimeSource::kPtp, .utc_offset = offset, .utc_error = microseconds(20)},
                milliseconds(100));
    EXPECT_EQ(receiver.capture_utc_us(now), static_cast<uint32_t>((capture + offset).count()));
    EXPECT_TRUE(receiver.capture_utc_us(now + milliseconds(300)));
    EXPECT_FALSE(receiver.capture_utc_us(now + microseconds(300'001))) << "too old";
    EXPECT_TRUE(receiver.capture_utc_us(now - milliseconds(100)));
    EXPECT_FALSE(receiver.capture_utc_us(now - microseconds(100'001))) << "set back";
  }
}

}  // namespace
}  // namespace bevloc::can
