// Publishes reports on a mock bus and reads them as a consumer does, with only the DBC file.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"
#include "tests/can/messages/dbc_parser.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::test {

class PosePublisherTest : public testing::Test {
 protected:
  void publish(const can::PoseReport& report, Time now) {
    frames_.clear();
    (with_clock_ ? *with_clock_ : publisher_).publish(report, now);
    while (const auto received = reader_->receive()) {
      frames_[dbc_.messages.at(received->frame.id).name] = received->frame;
    }
  }

  double value(const std::string& message, const std::string& signal) const {
    const DbcSignal& found = dbc_.message(message).signal(signal);
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

  const Dbc dbc_ = load_dbc(std::string(BEVLOC_SOURCE_DIR) + "/can/bevloc.dbc");
  can::MockWire wire_;
  std::unique_ptr<can::Bus> sender_ = wire_.connect();
  std::unique_ptr<can::Bus> reader_ = wire_.connect();
  can::PosePublisher publisher_{*sender_, {.map_origin = kOrigin}};
  std::optional<can::PosePublisher> with_clock_;  ///< publishes instead, if there is one
  std::map<std::string, can::Frame> frames_;
};

}  // namespace bevloc::test
