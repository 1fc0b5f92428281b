// Logs all frames of localizer and vehicle and checks them with a reader that knows only the DBC
// file.
#include "tests/can/e2e/independent_e2e.h"

#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "can/bus/candump.h"
#include "can/bus/mock_bus.h"
#include "can/messages/vehicle_encoder.h"
#include "can/publisher/pose_publisher.h"

namespace bevloc {
namespace {

using std::chrono::milliseconds;

constexpr can::GeodeticPosition kOrigin{49.0069, 8.4037};

/// Returns the log of one second: a localizer in state TRACKING and a vehicle that drives.
std::vector<std::string> one_second_of_bus(can::FrameFormat format = can::FrameFormat::kClassic) {
  can::MockWire wire;
  const auto localizer = wire.connect();
  const auto vehicle = wire.connect();
  const auto logger = wire.connect();
  can::PosePublisher publisher(*localizer, {.map_origin = kOrigin, .format = format});
  can::VehicleEncoder encoder(can::BaseIds{}, kOrigin, 1.6);

  std::vector<std::string> lines;
  for (int cycle = 0; cycle < 100; ++cycle) {
    const Time now(milliseconds(10 * cycle + 1000));
    for (const can::Frame& frame : encoder.odometry({now, 10.0, 0.1})) vehicle->send(frame, now);
    if (cycle % 10 == 0) {
      for (const can::Frame& frame : encoder.gnss({now, 0.1 * cycle, 2.0, 1.0, 1.0, {}})) {
        vehicle->send(frame, now);
      }
    }
    can::PoseReport report;
    report.status.state = HealthState::kTracking;
    report.capture_time = now - milliseconds(60);
    report.pose_time = now;
    report.map_from_vehicle = {0.1 * cycle, 2.0, 0.0};
    report.covariance = 0.01 * Eigen::Matrix3d::Identity();
    publisher.publish(report, now);
    while (const auto received = logger->receive()) {
      lines.push_back(
          can::candump_line(received->received.time_since_epoch(), "can0", received->frame));
    }
  }
  return lines;
}

test::E2eLogReport check(const std::vector<std::string>& lines) {
  std::stringstream log;
  for (const std::string& line : lines) log << line << '\n';
  return test::check_candump_log(
      log, test::load_dbc(std::string(BEVLOC_SOURCE_DIR) + "/can/bevloc.dbc"));
}

TEST(IndependentE2e, FindsNoErrorOnTheClassicBus) {
  const auto report = check(one_second_of_bus());
  EXPECT_EQ(report.unreadable_lines, 0);
  EXPECT_EQ(report.unknown_frames, 0);
  EXPECT_EQ(report.by_message.size(), 16u);
  for (const auto& [name, tally] : report.by_message) EXPECT_TRUE(tally.is_clean()) << name;
  EXPECT_EQ(report.by_message.at("LOC_PosLocal").good, 100);
  EXPECT_EQ(report.by_message.at("LOC_Status").good, 10);
  EXPECT_EQ(report.by_message.at("LOC_Integrity").good, 100);
  EXPECT_EQ(report.by_message.at("LOC_Identity").good, 5);
  EXPECT_EQ(report.by_message.at("VEH_GnssHeading").good, 10);
}

TEST(IndependentE2e, FindsNoErrorOnTheFdBus) {
  const auto report = check(one_second_of_bus(can::FrameFormat::kFd));
  EXPECT_EQ(report.unreadable_lines, 0);
  EXPECT_EQ(report.unknown_frames, 0);
  EXPECT_EQ(report.by_message.size(), 6u) << "one of the localizer and five of the vehicle";
  for (const auto& [name, tally] : report.by_message) EXPECT_TRUE(tally.is_clean()) << name;
  EXPECT_EQ(report.by_message.at("LOC_Solution").good, 100);
}

TEST(IndependentE2e, FindsADamagedFdFrame) {
  auto lines = one_second_of_bus(can::FrameFormat::kFd);
  for (std::string& line : lines) {
    if (line.find(" 509##1") != std::string::npos) line.back() = line.back() == '0' ? '1' : '0';
  }
  EXPECT_EQ(check(lines).by_message.at("LOC_Solution").wrong_crc, 100);
}

TEST(IndependentE2e, ReadsThePoseWithOnlyTheDbcFile) {
  std::stringstream log;
  for (const std::string& line : one_second_of_bus()) log << line << '\n';
  double last_east_m = -1.0;
  test::check_candump_log(log, test::load_dbc(std::string(BEVLOC_SOURCE_DIR) + "/can/bevloc.dbc"),
                          [&](const test::DbcMessage& message, const test::LoggedFrame& frame) {
                            if (message.name != "LOC_PosLocal") return;
                            last_east_m = message.signal("LocalEast").physical_from(frame.bytes);
                          });
  EXPECT_NEAR(last_east_m, 9.9, 1e-9);
}

TEST(IndependentE2e, FindsDamageLossAndRepetition) {
  const auto lines = one_second_of_bus();
  std::vector<size_t> velocity_lines;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].find(" 506#") != std::string::npos) velocity_lines.push_back(i);
  }
  auto damaged = lines;
  char& digit = damaged[velocity_lines[5]].back();
  digit = digit == '0' ? '1' : '0';
  damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(velocity_lines[20]),
                 damaged[velocity_lines[19]]);
  damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(velocity_lines[10]));
  damaged.push_back("(2.000000) can0 506#00");
  damaged.push_back("(2.000000) can0 123#00");
  damaged.push_back("rubbish");
  const auto report = check(damaged);
  const test::E2eTally& tally = report.by_message.at("LOC_Velocity");
  EXPECT_EQ(tally.wrong_crc, 1);
  EXPECT_EQ(tally.lost, 2) << "the damaged frame and the removed one";
  EXPECT_EQ(tally.repeated, 1);
  EXPECT_EQ(tally.wrong_length, 1);
  EXPECT_EQ(tally.good, 98);
  EXPECT_EQ(report.unknown_frames, 1);
  EXPECT_EQ(report.unreadable_lines, 1);
}

TEST(IndependentE2e, KnowsThePublishedVector) {
  EXPECT_EQ(test::expected_p02_crc({0, 1, 0, 0, 0, 0, 0, 0}, 0), 0x45);
  EXPECT_EQ(test::expected_p05_crc({0, 0, 1, 0, 0, 0, 0, 0}, 0x1234), 0x8DCF);
}

}  // namespace
}  // namespace bevloc
