// Drives on a vehicle with a bus of its own: poses and samples are those of the standard messages.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "evaluation/bench/allocation_count.h"
#include "evaluation/campaign/stage_run.h"
#include "evaluation/drive/simulated_drive.h"
#include "firmware/devices/can_bus.h"
#include "sim/faults/fault_table.h"

namespace bevloc::evaluation {
namespace {

constexpr Time kStart{std::chrono::seconds(100)};
constexpr double kDuration_s = 30.0;

DriveConfig config_of(const std::string& name) {
  auto config = load_drive_config(std::string(BEVLOC_SOURCE_DIR) + "/config/" + name);
  EXPECT_TRUE(config) << config.error().message;
  config->simulation->duration_s = kDuration_s;
  return *config;
}

std::vector<JudgedCycle> cycles_of(const DriveConfig& config) {
  const auto table =
      read_match_table(std::string(BEVLOC_SOURCE_DIR) + "/evaluation/campaign/matches.csv");
  EXPECT_TRUE(table) << table.error().message;
  std::vector<JudgedCycle> cycles;
  const Status ran = run_stage(config, Mode{}, *table,
                               [&cycles](const JudgedCycle& cycle) { cycles.push_back(cycle); });
  EXPECT_TRUE(ran) << ran.error().message;
  return cycles;
}

void add(const can::VehicleSamples& samples, std::vector<VehicleSample>& all) {
  if (samples.odometry) all.push_back(*samples.odometry);
  if (samples.gnss) all.push_back(*samples.gnss);
}

double first_pose_s(const std::vector<JudgedCycle>& cycles) {
  const auto first =
      std::ranges::find_if(cycles, [](const JudgedCycle& cycle) { return cycle.pose.has_value(); });
  EXPECT_NE(first, cycles.end());
  return first == cycles.end() ? kDuration_s : first->time_s;
}

// The two buses send their signals with different resolutions. So one drive may need more matches
// than the other before its pose is valid. The two poses then differ for some seconds, because
// their first errors differ.
TEST(OwnBusTest, GivesThePosesOfTheStandardMessages) {
  const auto standard = cycles_of(config_of("demo.yaml"));
  const auto own = cycles_of(config_of("demo_own_bus.yaml"));
  ASSERT_EQ(own.size(), standard.size());
  EXPECT_NEAR(first_pose_s(own), first_pose_s(standard), 1.0);
  constexpr double kStartForgotten_s = 10.0;
  size_t both = 0;
  for (size_t i = 0; i < own.size(); ++i) {
    if (!own[i].pose || !standard[i].pose) continue;
    ++both;
    const Eigen::Vector3d difference = own[i].pose->error - standard[i].pose->error;
    const double limit_m = own[i].time_s < kStartForgotten_s ? 0.3 : 0.03;
    EXPECT_LT(difference.head<2>().norm(), limit_m) << own[i].time_s;
    EXPECT_LT(std::abs(difference.z()), radians(0.03)) << own[i].time_s;
  }
  EXPECT_GT(both, own.size() / 2);
}

TEST(OwnBusTest, GivesTheSamplesOfTheStandardMessagesWithoutAllocation) {
  const DriveConfig config = config_of("demo_own_bus.yaml");
  const auto drive = SimulatedDrive::create(config);
  ASSERT_TRUE(drive) << drive.error().message;
  const can::GeodeticPosition origin{drive->map().origin.latitude_deg,
                                     drive->map().origin.longitude_deg};
  firmware::CanConfig standard = config.can;
  standard.vehicle.reset();
  can::MockWire own_wire;
  can::MockWire standard_wire;
  const auto own_bus = own_wire.connect();
  const auto standard_bus = standard_wire.connect();
  SimulatedVehicle own_vehicle(*drive, 1, config.can, own_wire.connect(), kStart);
  SimulatedVehicle standard_vehicle(*drive, 1, standard, standard_wire.connect(), kStart);
  const auto own_decoder = firmware::make_vehicle_decoder(config.can, origin);
  const auto standard_decoder = firmware::make_vehicle_decoder(standard, origin);
  std::vector<VehicleSample> own;
  std::vector<VehicleSample> wanted;
  own.reserve(10'000);
  for (Time now = kStart; now < kStart + from_seconds(kDuration_s); now = own_vehicle.next_due()) {
    own_vehicle.send_due(now);
    standard_vehicle.send_due(now);
    while (const auto frame = standard_bus->receive()) {
      add(standard_decoder->accept(*frame), wanted);
    }
    while (const auto frame = own_bus->receive()) {
      const uint64_t before = bench::allocation_count();
      const can::VehicleSamples samples = own_decoder->accept(*frame);
      EXPECT_EQ(bench::allocation_count(), before);
      add(samples, own);
    }
  }
  ASSERT_EQ(own.size(), wanted.size());
  EXPECT_GT(own.size(), 1700U);
  for (size_t i = 0; i < own.size(); ++i) {
    ASSERT_EQ(own[i].index(), wanted[i].index());
    if (const auto* odometry = std::get_if<OdometrySample>(&own[i])) {
      const auto& other = std::get<OdometrySample>(wanted[i]);
      EXPECT_EQ(odometry->time, other.time);
      EXPECT_NEAR(odometry->speed_mps, other.speed_mps, 0.005);
      EXPECT_NEAR(odometry->yaw_rate_radps, other.yaw_rate_radps, radians(0.005));
      continue;
    }
    const auto& gnss = std::get<GnssSample>(own[i]);
    const auto& other = std::get<GnssSample>(wanted[i]);
    EXPECT_EQ(gnss.time, other.time);
    EXPECT_NEAR(gnss.east_m, other.east_m, 0.02);
    EXPECT_NEAR(gnss.north_m, other.north_m, 0.02);
    EXPECT_NEAR(gnss.sigma_east_m, other.sigma_east_m, 0.011);
    ASSERT_EQ(gnss.yaw.has_value(), other.yaw.has_value());
    if (gnss.yaw) {
      EXPECT_NEAR(gnss.yaw->yaw_rad, other.yaw->yaw_rad, radians(0.011));
    }
  }
}

sim::Fault yaw_rate_bias(double from_s) {
  sim::Fault bias = sim::make_fault(sim::FaultKind::kYawRateBias, from_s);
  bias.amounts.bias_degps = 3.0;
  return bias;
}

/// The frames with the front wheels during the first 4 seconds.
std::vector<can::Frame> front_wheels_with(const std::vector<sim::Fault>& faults) {
  DriveConfig config = config_of("demo_own_bus.yaml");
  config.simulation->faults = faults;
  const auto drive = SimulatedDrive::create(config);
  EXPECT_TRUE(drive) << drive.error().message;
  const auto message =
      std::ranges::find(config.can.vehicle->messages, "ESP_WheelsFront", &can::BoundMessage::name);
  EXPECT_NE(message, config.can.vehicle->messages.end());
  can::MockWire wire(4096);
  const auto bus = wire.connect();
  SimulatedVehicle vehicle(*drive, 1, config.can, wire.connect(), kStart);
  vehicle.send_due(kStart + std::chrono::seconds(4));
  std::vector<can::Frame> frames;
  while (const auto received = bus->receive()) {
    if (received->frame.id == message->id) frames.push_back(received->frame);
  }
  return frames;
}

TEST(OwnBusTest, AFaultOfTheYawRateOrOfTheRearWheelsLeavesTheFrontWheels) {
  const std::vector<can::Frame> healthy = front_wheels_with({});
  EXPECT_GT(healthy.size(), 190U);
  sim::Fault rear = sim::make_fault(sim::FaultKind::kOdometryWheels);
  rear.amounts.left_mps = 22.2;
  EXPECT_EQ(front_wheels_with({yaw_rate_bias(0.0)}), healthy);
  EXPECT_EQ(front_wheels_with({rear}), healthy);
  sim::Fault spinning = sim::make_fault(sim::FaultKind::kOdometrySlip);
  EXPECT_NE(front_wheels_with({spinning}), healthy) << "all wheels spin";
}

TEST(OwnBusTest, AWrongYawRateContradictsTheFourWheelsWithinASecond) {
  constexpr double kFrom_s = 10.0;
  DriveConfig config = config_of("demo_own_bus.yaml");
  config.simulation->faults = {yaw_rate_bias(kFrom_s)};
  const auto cycles = cycles_of(config);
  const auto noticed = std::ranges::find_if(
      cycles, [](const JudgedCycle& cycle) { return cycle.why.has(Why::kOdometryImplausible); });
  ASSERT_NE(noticed, cycles.end());
  EXPECT_GE(noticed->time_s, kFrom_s);
  EXPECT_LT(noticed->time_s, kFrom_s + 1.0);
}

TEST(OwnBusTest, AHeadingThatIsAlwaysValidCannotBeMissing) {
  DriveConfig config = config_of("demo_own_bus.yaml");
  config.simulation->faults = {sim::make_fault(sim::FaultKind::kGnssNoHeading)};
  EXPECT_TRUE(SimulatedDrive::create(config));
  config.can.vehicle->gnss->heading_valid.reset();
  const auto refused = SimulatedDrive::create(config);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              testing::HasSubstr("simulation.faults: found gnss_no_heading, wanted "
                                 "can.vehicle.gnss.heading_valid"));
  config.can.vehicle->gnss->heading.reset();
  EXPECT_TRUE(SimulatedDrive::create(config)) << "this bus has no heading at all";
}

/// What the appliance reads during the first 8 seconds.
struct Read {
  std::vector<OdometrySample> odometry;
  std::optional<Time> second_sender;  ///< when it noticed one for the first time
};

Read read_with(DriveConfig config, const std::vector<sim::Fault>& faults) {
  config.simulation->faults = faults;
  const auto drive = SimulatedDrive::create(config);
  EXPECT_TRUE(drive) << drive.error().message;
  can::MockWire wire;
  const auto bus = wire.connect();
  SimulatedVehicle vehicle(*drive, 1, config.can, wire.connect(), kStart);
  const auto decoder = firmware::make_vehicle_decoder(
      config.can, {drive->map().origin.latitude_deg, drive->map().origin.longitude_deg});
  Read read;
  for (Time now = kStart; now < kStart + std::chrono::seconds(8); now = vehicle.next_due()) {
    vehicle.send_due(now);
    while (const auto frame = bus->receive()) {
      if (const auto sample = decoder->accept(*frame).odometry) read.odometry.push_back(*sample);
    }
    if (!read.second_sender) read.second_sender = decoder->fault_times().foreign_sender;
  }
  return read;
}

sim::Fault forged_from(double from_s) {
  sim::Fault forged = sim::make_fault(sim::FaultKind::kBusForged, from_s);
  forged.amounts.speed_mps = 10.0;
  forged.amounts.yaw_rate_degps = 5.0;
  return forged;
}

TEST(OwnBusTest, ForgedOdometryIsNoticedAsOnTheStandardBus) {
  for (const char* name : {"demo.yaml", "demo_own_bus.yaml"}) {
    SCOPED_TRACE(name);
    const Read read = read_with(config_of(name), {forged_from(6.0)});
    ASSERT_TRUE(read.second_sender);
    EXPECT_GE(*read.second_sender, kStart + std::chrono::seconds(6));
    EXPECT_LT(*read.second_sender, kStart + std::chrono::milliseconds(6200));
  }
}

TEST(OwnBusTest, TheForgerSendsItsValuesInTheVehiclesOwnMessages) {
  sim::Fault forged = forged_from(0.0);
  forged.amounts.counter_step = 1.0;
  const Read read = read_with(config_of("demo_own_bus.yaml"),
                              {sim::make_fault(sim::FaultKind::kOdometryMissing), forged});
  EXPECT_GT(read.odometry.size(), 380U);
  for (const OdometrySample& sample : read.odometry) {
    EXPECT_NEAR(sample.speed_mps, 10.0, 0.005);
    EXPECT_NEAR(sample.yaw_rate_radps, radians(5.0), radians(0.005));
  }
}

}  // namespace
}  // namespace bevloc::evaluation
