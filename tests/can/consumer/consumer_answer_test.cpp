// Asks a consumer whether it may use a pose (can/consumer/bevloc.hpp).
#include <array>
#include <bit>

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/consumer/bevloc.hpp"
#include "can/publisher/pose_publisher.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr consumer::AlertLimits kWide = {5.0, 5.0, 5.0, 5};

/// A localizer that publishes one report every 10 ms, and its consumer.
class Link {
 public:
  explicit Link(const consumer::AlertLimits& limits, FrameFormat format = FrameFormat::kClassic)
      : receiver_(limits),
        publisher_(*sender_, {.map_origin = test::kOrigin, .format = format, .sends_clock = true}) {
  }

  /// The answer after `poses` complete poses.
  consumer::Answer publish(PoseReport report, int poses) {
    for (int i = 0; i < poses; ++i) {
      now_ += milliseconds(10);
      report.pose_time = time();
      publisher_.publish(report, time());
      while (const auto received = reader_->receive()) {
        receiver_.receive(received->frame.id, received->frame.payload(), now_);
      }
    }
    return receiver_.answer(now_);
  }
  consumer::Answer publish_after(Duration silence, const PoseReport& report) {
    now_ += std::chrono::duration_cast<microseconds>(silence) - milliseconds(10);
    return publish(report, 1);
  }
  int map_id() const { return receiver_.map_id(); }
  uint32_t why() const { return receiver_.why(); }
  std::optional<uint32_t> capture_utc_us() const { return receiver_.capture_utc_us(now_); }

 private:
  Time time() const { return test::kNow + now_; }

  MockWire wire_;
  std::unique_ptr<Bus> sender_ = wire_.connect();
  std::unique_ptr<Bus> reader_ = wire_.connect();
  consumer::Receiver receiver_;
  PosePublisher publisher_;
  microseconds now_{};
};

TEST(ConsumerAnswerTest, DoesNotUseTheFirstPoseAfterASilence) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    Link link(kWide, format);
    const PoseReport report = test::tracking_report(test::kNow);
    EXPECT_EQ(link.publish(report, 1), BEVLOC_TIMEOUT) << "may be an old one";
    EXPECT_EQ(link.publish(report, 1), BEVLOC_USABLE);
    EXPECT_EQ(link.publish_after(milliseconds(30), report), BEVLOC_USABLE);
    EXPECT_EQ(link.publish_after(milliseconds(31), report), BEVLOC_TIMEOUT);
    EXPECT_EQ(link.publish(report, 1), BEVLOC_USABLE);
  }
}

TEST(ConsumerAnswerTest, UsesNoPoseWhileSomebodyElseSendsTheVehiclesMessages) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    Link link(kWide, format);
    PoseReport report = test::tracking_report(test::kNow);
    EXPECT_EQ(link.publish(report, 2), BEVLOC_USABLE);
    report.status.why |= Why::kForeignSender;
    EXPECT_EQ(link.publish(report, 1), BEVLOC_FOREIGN_SENDER);
  }
}

TEST(ConsumerAnswerTest, TellsTheMap) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    Link link(kWide, format);
    PoseReport report = test::tracking_report(test::kNow);
    report.status.map_id = 0xBEE5;
    link.publish(report, 10);
    EXPECT_EQ(link.map_id(), 0xBEE5);
  }
}

TEST(ConsumerAnswerTest, TellsEveryReason) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    Link link(kWide, format);
    PoseReport report = test::tracking_report(test::kNow);
    const auto bits_of = [&](WhyMask why) {
      report.status.why = why;
      link.publish(report, 10);
      return link.why();
    };
    uint32_t all = 0;
    for (int i = 0; i < kWhyCount; ++i) {
      const uint32_t bits = bits_of(WhyMask::from_bits(1u << i));
      EXPECT_EQ(std::popcount(bits), 1) << i;
      all |= bits;
    }
    EXPECT_EQ(std::popcount(all), kWhyCount) << "a bit of its own for each";
    EXPECT_EQ(bits_of(Why::kGnssMissing), BEVLOC_WHY(BEVLOC_LOC_Status_Why_GnssMissing));
    EXPECT_EQ(bits_of(Why::kClockGap), BEVLOC_WHY(BEVLOC_LOC_Integrity_Why_ClockGap));
    EXPECT_EQ(bits_of({}), 0u);
  }
}

/// A LOC_Status in TRACKING with this raw value of TimeSource.
std::array<uint8_t, 8> status_with(unsigned time_source, unsigned counter) {
  std::array<uint8_t, 8> bytes{};
  bytes[1] = static_cast<uint8_t>(counter % 16);
  bytes[2] = static_cast<uint8_t>(time_source << 4 | BEVLOC_LOC_Status_State_TRACKING);
  bytes[0] =
      bevloc_crc8(bytes.data(), bytes.size(), static_cast<uint8_t>(BEVLOC_LOC_Status.data_id));
  return bytes;
}

TEST(ConsumerAnswerTest, AnUnknownTimeSourceIsFreeRunning) {
  consumer::Receiver receiver(kWide);
  unsigned counter = 0;
  const auto source_after = [&](unsigned time_source) {
    receiver.receive(BEVLOC_LOCALIZER_BASE, status_with(time_source, counter++), microseconds(1));
    return receiver.time_source();
  };
  for (unsigned unknown = 4; unknown < 8; ++unknown) {
    EXPECT_EQ(source_after(BEVLOC_LOC_Status_TimeSource_PTP), BEVLOC_LOC_Status_TimeSource_PTP);
    EXPECT_EQ(source_after(unknown), BEVLOC_LOC_Status_TimeSource_FREE_RUNNING) << unknown;
  }
}

TEST(ConsumerAnswerTest, AnAxisWithoutALimitNeedsNoProtectionLevel) {
  PoseReport report = test::tracking_report(test::kNow);
  report.protection_level.longitudinal_m = 50.0;  // beyond the range, so it is sent as SNA
  EXPECT_EQ(Link({0.57, 0.0, 1.5, 5}).publish(report, 2), BEVLOC_USABLE);
  EXPECT_EQ(Link({0.57, 1.4, 1.5, 5}).publish(report, 2), BEVLOC_NOT_AVAILABLE);
  report.protection_level.lateral_m = ProtectionLevel::kUnknown;
  report.protection_level.yaw_rad = ProtectionLevel::kUnknown;
  EXPECT_EQ(Link({0.0, 0.0, 0.0, 5}).publish(report, 2), BEVLOC_USABLE);
  EXPECT_EQ(Link({0.57, 0.0, 0.0, 5}).publish(report, 2), BEVLOC_NOT_AVAILABLE);
  EXPECT_EQ(Link({0.0, 0.0, 1.5, 5}).publish(report, 2), BEVLOC_NOT_AVAILABLE);
}

TEST(ConsumerAnswerTest, NoLevelIsWithinALimitThatIsNegativeOrNotANumber) {
  const PoseReport report = test::tracking_report(test::kNow);
  for (const double limit : {-1.0, test::kNan}) {
    EXPECT_EQ(Link({limit, 5.0, 5.0, 5}).publish(report, 2), BEVLOC_BEYOND_LIMIT);
    EXPECT_EQ(Link({5.0, limit, 5.0, 5}).publish(report, 2), BEVLOC_BEYOND_LIMIT);
    EXPECT_EQ(Link({5.0, 5.0, limit, 5}).publish(report, 2), BEVLOC_BEYOND_LIMIT);
  }
}

TEST(ConsumerAnswerTest, KnowsNoCaptureTimeWithoutImages) {
  Link link(kWide);
  PoseReport report = test::tracking_report(test::kNow);
  report.clock = {.source = TimeSource::kPtp, .utc_offset = std::chrono::hours(1)};
  report.status.state = HealthState::kInit;
  const auto capture = report.capture_time;
  report.capture_time = std::nullopt;
  link.publish(report, 2);
  EXPECT_FALSE(link.capture_utc_us());
  report.capture_time = capture;
  link.publish(report, 1);
  EXPECT_TRUE(link.capture_utc_us());
}

}  // namespace
}  // namespace bevloc::can
