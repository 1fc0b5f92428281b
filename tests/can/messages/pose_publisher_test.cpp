#include "can/messages/pose_publisher.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "tests/can/messages/dbc_parser.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::kNan;
using test::kNow;
using test::kOrigin;
using test::tracking_report;

/// Reads the bus as a consumer does, with only the DBC file.
class PosePublisherTest : public testing::Test {
 protected:
  void publish(const PoseReport& report, Time now) {
    frames_.clear();
    (with_clock_ ? *with_clock_ : publisher_).publish(report, now);
    while (const auto received = reader_->receive()) {
      frames_[dbc_.messages.at(received->frame.id).name] = received->frame;
    }
  }

  double value(const std::string& message, const std::string& signal) const {
    const test::DbcSignal& found = dbc_.message(message).signal(signal);
    const auto payload = frames_.at(message).payload();
    EXPECT_FALSE(found.is_sna(payload)) << message << "." << signal;
    return found.physical_from(payload);
  }

  bool is_sna(const std::string& message, const std::string& signal) const {
    return dbc_.message(message).signal(signal).is_sna(frames_.at(message).payload());
  }

  void expect_no_pose() const {
    for (const auto& [message, signal] : std::vector<std::pair<std::string, std::string>>{
             {"LOC_Latitude", "Latitude"},
             {"LOC_Latitude", "StdDevNorth"},
             {"LOC_Longitude", "Longitude"},
             {"LOC_Longitude", "StdDevEast"},
             {"LOC_PosLocal", "LocalEast"},
             {"LOC_PosLocal", "LocalNorth"},
             {"LOC_Attitude", "Heading"},
             {"LOC_StdDev", "StdDevLongitudinal"},
             {"LOC_StdDev", "StdDevLateral"},
             {"LOC_StdDev", "StdDevHeading"},
             {"LOC_Integrity", "ProtectionLateral"},
             {"LOC_Integrity", "ProtectionLongitudinal"},
             {"LOC_Integrity", "ProtectionYaw"},
             {"LOC_Integrity", "IntegrityRiskExponent"}}) {
      EXPECT_TRUE(is_sna(message, signal)) << message << "." << signal;
    }
  }

  void expect_lost_because(const std::string& why) const {
    EXPECT_EQ(value("LOC_Status", "State"), 4.0);
    EXPECT_EQ(value("LOC_Status", why), 1.0);
    expect_no_pose();
  }

  const test::Dbc dbc_ = test::load_dbc(std::string(BEVLOC_SOURCE_DIR) + "/can/bevloc.dbc");
  MockWire wire_;
  std::unique_ptr<Bus> sender_ = wire_.connect();
  std::unique_ptr<Bus> reader_ = wire_.connect();
  PosePublisher publisher_{*sender_, {.map_origin = kOrigin}};
  std::optional<PosePublisher> with_clock_;  ///< publishes instead, if there is one
  std::map<std::string, Frame> frames_;
};

TEST_F(PosePublisherTest, AConsumerWithTheDbcFileReadsTheReport) {
  publish(tracking_report(kNow), kNow);
  EXPECT_EQ(frames_.size(), 11u);
  EXPECT_EQ(value("LOC_Status", "State"), 2.0);
  EXPECT_EQ(value("LOC_Status", "CameraOk_FrontLeft"), 1.0);
  EXPECT_EQ(value("LOC_Status", "CameraOk_Front"), 0.0);
  EXPECT_EQ(value("LOC_Status", "CameraOk_BackRight"), 1.0);
  EXPECT_EQ(value("LOC_Status", "OdometryOk"), 1.0);
  EXPECT_EQ(value("LOC_Status", "GnssOk"), 0.0);
  EXPECT_EQ(value("LOC_Status", "MapOk"), 1.0);
  EXPECT_EQ(value("LOC_Status", "MapId"), 0xBEEF);
  EXPECT_NEAR(value("LOC_Time", "CaptureAge"), 83.0, 0.051);
  EXPECT_NEAR(value("LOC_PosLocal", "LocalEast"), 123.456, 0.0051);
  EXPECT_NEAR(value("LOC_PosLocal", "LocalNorth"), -78.9, 0.0051);
  EXPECT_NEAR(value("LOC_Attitude", "Heading"), 60.0, 0.02);
  EXPECT_NEAR(value("LOC_Velocity", "VelocityX"), 13.37, 0.0051);
  EXPECT_NEAR(value("LOC_Velocity", "YawRate"), -4.2, 0.0051);
  EXPECT_NEAR(value("LOC_Latitude", "StdDevNorth"), 0.1, 1e-9);
  EXPECT_NEAR(value("LOC_Longitude", "StdDevEast"), 0.2, 1e-9);
  EXPECT_NEAR(value("LOC_Correction", "DeltaLongitudinal"), 0.432, 1e-9);
  EXPECT_NEAR(value("LOC_Correction", "DeltaLateral"), -0.123, 1e-9);
  EXPECT_NEAR(value("LOC_Correction", "DeltaYaw"), 0.57, 1e-9);
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionLongitudinal"), 1.24, 1e-9) << "rounded up";
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionLateral"), 0.51, 1e-9) << "rounded up";
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionYaw"), 1.45, 1e-9) << "rounded up";
  EXPECT_EQ(value("LOC_Integrity", "IntegrityRiskExponent"), 5.0);
}

TEST_F(PosePublisherTest, LatitudeAndLongitudeRoundTripTo1Cm) {
  GeoReference geo(kOrigin);
  PoseReport report = tracking_report(kNow);
  for (const double x_m : {-9000.0, -0.004, 25.5, 7777.77}) {
    report.map_from_vehicle = {x_m, 0.5 * x_m + 3.0, 0.3};
    publish(report, kNow);
    const Se2 back = geo.map_from_geodetic(
        {{value("LOC_Latitude", "Latitude"), value("LOC_Longitude", "Longitude")}, 0.0});
    EXPECT_NEAR(back.x_m, report.map_from_vehicle.x_m, 0.01);
    EXPECT_NEAR(back.y_m, report.map_from_vehicle.y_m, 0.01);
  }
}

TEST_F(PosePublisherTest, StandardDeviationsAreAlongTheVehiclesAxes) {
  PoseReport report = tracking_report(kNow);
  const double yaw_rad = radians(30.0);
  const Eigen::Vector2d along(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  report.covariance.topLeftCorner<2, 2>() =
      0.3 * 0.3 * along * along.transpose() + 0.05 * 0.05 * across * across.transpose();
  publish(report, kNow);
  EXPECT_NEAR(value("LOC_StdDev", "StdDevLongitudinal"), 0.30, 1e-9);
  EXPECT_NEAR(value("LOC_StdDev", "StdDevLateral"), 0.05, 1e-9);
  EXPECT_NEAR(value("LOC_StdDev", "StdDevHeading"), 0.58, 1e-9) << "0.573 degrees, rounded up";
}

TEST_F(PosePublisherTest, AProtectionLevelOutOfRangeIsNotAvailable) {
  PoseReport report = tracking_report(kNow);
  report.protection_level = {
      .longitudinal_m = 40.941, .lateral_m = 20.46, .yaw_rad = -0.1, .integrity_risk = 3e-6};
  publish(report, kNow);
  EXPECT_TRUE(is_sna("LOC_Integrity", "ProtectionLongitudinal"));
  EXPECT_NEAR(value("LOC_Integrity", "ProtectionLateral"), 20.46, 1e-9) << "the largest value";
  EXPECT_TRUE(is_sna("LOC_Integrity", "ProtectionYaw")) << "no bound is negative";
  EXPECT_EQ(value("LOC_Integrity", "IntegrityRiskExponent"), 5.0) << "at most 1e-5, but not 1e-6";

  const Time later = kNow + seconds(1);
  report = tracking_report(later);
  report.protection_level = {};
  publish(report, later);
  EXPECT_TRUE(is_sna("LOC_Integrity", "ProtectionLateral"));
  EXPECT_TRUE(is_sna("LOC_Integrity", "IntegrityRiskExponent"));
  EXPECT_EQ(value("LOC_Status", "State"), 2.0) << "a pose without a bound is still a pose";
}

TEST_F(PosePublisherTest, EachReasonHasItsFlag) {
  PoseReport report = tracking_report(kNow);
  for (int bit = 0; bit < kWhyCount; ++bit) {
    report.status.why = static_cast<Why>(1u << bit);
    publish(report, kNow);
    int flags = 0;
    for (const char* message : {"LOC_Status", "LOC_Integrity"}) {
      for (const test::DbcSignal& signal : dbc_.message(message).signals) {
        if (signal.name.starts_with("Why_")) flags += value(message, signal.name) != 0.0;
      }
    }
    EXPECT_EQ(flags, 1) << to_string(report.status.why);
  }
}

/// A reader adds CaptureTime and UtcOffset modulo 2^32 us. The date lies after 2038, when 32 bits
/// of seconds overflow.
TEST_F(PosePublisherTest, AReaderKnowsTheCaptureTimeInUtc) {
  constexpr Duration kIn2040 = seconds(2'224'540'800) + microseconds(123'456);
  with_clock_.emplace(*sender_, PosePublisherConfig{.map_origin = kOrigin, .sends_clock = true});
  PoseReport report = tracking_report(kNow);
  report.clock = {
      .source = TimeSource::kPtp, .utc_offset = kIn2040, .utc_error = microseconds(1234)};
  publish(report, kNow);
  const auto utc_us = static_cast<uint64_t>(value("LOC_Time", "CaptureTime")) +
                      static_cast<uint64_t>(value("LOC_Clock", "UtcOffset"));
  const auto expected =
      std::chrono::floor<microseconds>(report.capture_time->time_since_epoch() + kIn2040);
  EXPECT_EQ(static_cast<uint32_t>(utc_us), static_cast<uint32_t>(expected.count()));
  EXPECT_NEAR(value("LOC_Clock", "UtcError"), 1.24, 1e-9) << "rounded up";

  publish(report, kNow + milliseconds(10));
  EXPECT_FALSE(frames_.contains("LOC_Clock")) << "every 100 ms";
  report.clock.source = TimeSource::kFreeRunning;
  publish(report, kNow + milliseconds(100));
  EXPECT_TRUE(is_sna("LOC_Clock", "UtcError"));
  report.clock = {.source = TimeSource::kNtp, .utc_error = milliseconds(656)};
  publish(report, kNow + milliseconds(200));
  EXPECT_TRUE(is_sna("LOC_Clock", "UtcError")) << "beyond the range";
}

TEST_F(PosePublisherTest, CaptureTimeIsModulo32BitMicroseconds) {
  PoseReport report = tracking_report(kNow);
  report.capture_time = kNow - microseconds(1500);
  publish(report, kNow);
  EXPECT_EQ(value("LOC_Time", "CaptureTime"), 5000e6 - 1500.0 - 4294967296.0);
}

TEST_F(PosePublisherTest, FramesOfOneSolutionShareAnEpochAndCountersRise) {
  for (int cycle = 0; cycle < 40; ++cycle) {
    const Time now = kNow + milliseconds(10 * cycle);
    publish(tracking_report(now), now);
    for (const auto& [message, frame] : frames_) {
      EXPECT_EQ(value(message, "EPOCH"), cycle % 16) << message;
      if (message == "LOC_Status" || message == "LOC_Identity") continue;
      EXPECT_EQ(value(message, "COUNTER"), cycle % 16) << message;
    }
  }
}

TEST_F(PosePublisherTest, StatusIsSentOnItsCycleAndOnChange) {
  std::vector<int> cycles_with_status;
  for (int cycle = 0; cycle < 30; ++cycle) {
    const Time now = kNow + milliseconds(10 * cycle);
    PoseReport report = tracking_report(now);
    if (cycle >= 14) report.status.state = HealthState::kDegraded;
    publish(report, now);
    if (frames_.contains("LOC_Status")) cycles_with_status.push_back(cycle);
    EXPECT_EQ(frames_.size(),
              9u + frames_.contains("LOC_Status") + frames_.contains("LOC_Identity"));
  }
  EXPECT_EQ(cycles_with_status, (std::vector<int>{0, 10, 14, 24}));
}

TEST_F(PosePublisherTest, StatusKeepsItsCycleWhenCallsAreEarlyAndLate) {
  std::vector<int> cycles_with_status;
  for (int cycle = 0; cycle <= 40; ++cycle) {
    const milliseconds late(cycle % 20 == 0 ? 2 : -2);
    const Time now = kNow + milliseconds(10 * cycle) + late;
    publish(tracking_report(now), now);
    if (frames_.contains("LOC_Status")) cycles_with_status.push_back(cycle);
  }
  EXPECT_EQ(cycles_with_status, (std::vector<int>{0, 10, 20, 30, 40}));
}

TEST_F(PosePublisherTest, TheIdentityIsKnownAfterOneSecond) {
  const Identity identity{
      .program = 1, .configuration = 2, .model = 0xFFFFFFFF, .rig = 0x80000000, .map = 0xDEADBEEF};
  PosePublisher publisher(*sender_, {.map_origin = kOrigin, .identity = identity});
  const test::DbcMessage& message = dbc_.message("LOC_Identity");
  std::map<double, double> checksums;
  std::vector<int> cycles;
  for (int cycle = 0; cycle < 100; ++cycle) {
    const Time now = kNow + milliseconds(10 * cycle);
    publisher.publish(tracking_report(now), now);
    while (const auto received = reader_->receive()) {
      if (received->frame.id != message.id) continue;
      const auto payload = received->frame.payload();
      cycles.push_back(cycle);
      checksums[message.signal("IdentityItem").physical_from(payload)] =
          message.signal("IdentityChecksum").physical_from(payload);
    }
  }
  EXPECT_EQ(cycles, (std::vector<int>{0, 20, 40, 60, 80}));
  const std::map<double, double> wanted = {
      {0, 1}, {1, 2}, {2, 0xFFFFFFFF}, {3, 0x80000000}, {4, 0xDEADBEEF}};
  EXPECT_EQ(checksums, wanted);
}

TEST_F(PosePublisherTest, AStatusThatCouldNotBeSentIsSentAgain) {
  wire_.set_down(true);
  publish(tracking_report(kNow), kNow);
  EXPECT_TRUE(frames_.empty());
  wire_.set_down(false);
  publish(tracking_report(kNow), kNow + milliseconds(10));
  EXPECT_TRUE(frames_.contains("LOC_Status"));
}

TEST_F(PosePublisherTest, NoPoseIsSentWithoutTracking) {
  for (const auto state :
       {HealthState::kInit, HealthState::kAcquiring, HealthState::kLost, HealthState::kFault}) {
    PoseReport report = tracking_report(kNow);
    report.status.state = state;
    report.status.why = Why::kNoInitialPose | Why::kGnssMissing;
    publish(report, kNow);
    EXPECT_EQ(value("LOC_Status", "State"), static_cast<double>(state));
    EXPECT_EQ(value("LOC_Status", "Why_NoInitialPose"), 1.0);
    EXPECT_EQ(value("LOC_Status", "Why_GnssMissing"), 1.0);
    EXPECT_EQ(value("LOC_Status", "Why_PoseInvalid"), 0.0);
    expect_no_pose();
  }
}

TEST_F(PosePublisherTest, APoseThatIsNotFiniteIsNeverValid) {
  Time now = kNow;
  for (double Se2::*member : {&Se2::x_m, &Se2::y_m, &Se2::yaw_rad}) {
    for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
      now += seconds(1);
      PoseReport report = tracking_report(now);
      report.map_from_vehicle.*member = bad;
      publish(report, now);
      expect_lost_because("Why_PoseInvalid");
    }
  }
}

TEST_F(PosePublisherTest, APoseWithAnInvalidCovarianceIsNeverValid) {
  PoseReport report = tracking_report(kNow);
  report.covariance(0, 1) = kNan;
  publish(report, kNow);
  expect_lost_because("Why_PoseInvalid");

  report = tracking_report(kNow + seconds(1));
  report.covariance(2, 2) = -1e-6;
  publish(report, kNow + seconds(1));
  expect_lost_because("Why_PoseInvalid");

  report = tracking_report(kNow + seconds(2));
  report.covariance(0, 1) = report.covariance(1, 0) = 0.03;
  publish(report, kNow + seconds(2));
  expect_lost_because("Why_PoseInvalid");
}

TEST_F(PosePublisherTest, APositionOutOfRangeIsNotSaturated) {
  PoseReport report = tracking_report(kNow);
  report.map_from_vehicle.x_m = 83887.0;
  publish(report, kNow);
  expect_lost_because("Why_PoseInvalid");
}

TEST_F(PosePublisherTest, AStalePoseIsNeverValid) {
  PoseReport report = tracking_report(kNow);
  publish(report, kNow + milliseconds(51));
  expect_lost_because("Why_PoseStale");
  EXPECT_TRUE(is_sna("LOC_Velocity", "VelocityX"));
  EXPECT_TRUE(is_sna("LOC_Correction", "DeltaYaw"));

  const Time later = kNow + seconds(1);
  report = tracking_report(later);
  report.capture_time = later - milliseconds(5001);
  publish(report, later);
  expect_lost_because("Why_PoseStale");

  const Time latest = kNow + seconds(2);
  report = tracking_report(latest);
  report.capture_time.reset();
  publish(report, latest);
  expect_lost_because("Why_PoseStale");
  EXPECT_TRUE(is_sna("LOC_Time", "CaptureAge"));

  const Time last = kNow + seconds(3);
  report = tracking_report(last);
  report.capture_time = last + milliseconds(1);
  publish(report, last);
  expect_lost_because("Why_PoseStale");
  EXPECT_TRUE(is_sna("LOC_Time", "CaptureAge"));
}

TEST_F(PosePublisherTest, AnAgeOfTheImagesBeyondTheRangeIsSna) {
  PoseReport report = tracking_report(kNow);
  report.capture_time = kNow - milliseconds(6553);
  publish(report, kNow);
  EXPECT_NEAR(value("LOC_Time", "CaptureAge"), 6553.0, 0.051);
  const Time later = kNow + seconds(1);
  report.capture_time = later - milliseconds(6554);
  publish(report, later);
  EXPECT_TRUE(is_sna("LOC_Time", "CaptureAge"));
}

TEST_F(PosePublisherTest, AnEmptyReportIsSnaEverywhere) {
  publish(PoseReport{}, kNow);
  expect_no_pose();
  for (const auto& [name, frame] : frames_) {
    for (const test::DbcSignal& signal : dbc_.message(name).signals) {
      const bool can_be_sna = std::ranges::any_of(
          signal.value_names, [](const auto& entry) { return entry.second == "SNA"; });
      EXPECT_EQ(signal.is_sna(frame.payload()), can_be_sna) << name << "." << signal.name;
    }
  }
}

TEST_F(PosePublisherTest, RandomReportsGiveNoSignalOutOfRange) {
  std::mt19937 random(7);
  const double odd[] = {0.0,  -0.0,     1e-300, 1e300,   -1e300,
                        kNan, 83886.07, -4e5,   3.14159, std::numeric_limits<double>::infinity()};
  const auto draw = [&] { return odd[random() % std::size(odd)]; };
  for (int i = 0; i < 5000; ++i) {
    const Time now = kNow + milliseconds(10 * i);
    PoseReport report = tracking_report(now);
    if (random() % 2 == 0) report.map_from_vehicle = {draw(), draw(), draw()};
    if (random() % 2 == 0) report.covariance.setConstant(draw());
    report.forward_speed_mps = draw();
    report.yaw_rate_radps = draw();
    report.correction = Se2{draw(), draw(), draw()};
    report.protection_level = {draw(), draw(), draw(), draw()};
    publish(report, now);
    for (const auto& [name, frame] : frames_) {
      for (const test::DbcSignal& signal : dbc_.message(name).signals) {
        if (signal.is_sna(frame.payload())) continue;
        const double physical = signal.physical_from(frame.payload());
        ASSERT_GE(physical, signal.min - 1e-9) << name << "." << signal.name;
        ASSERT_LE(physical, signal.max + 1e-9) << name << "." << signal.name;
      }
    }
  }
}

}  // namespace
}  // namespace bevloc::can
