// Shows that each fault of a simulated drive reaches the bus, the frames or the map.
#include <algorithm>

#include <gtest/gtest.h>

#include "can/e2e/e2e_p02.h"
#include "can/messages/message_table.h"
#include "evaluation/drive/faulty_bus.h"
#include "evaluation/drive/simulated_drive.h"
#include "sim/faults/fault_table.h"
#include "tests/evaluation/drive/drive_with_faults.h"

namespace bevloc::evaluation {
namespace {

using sim::FaultKind;
using sim::make_fault;
using test::drive_with_faults;

constexpr Time kStart{std::chrono::seconds(100)};

struct Odometry {
  Time time;
  double speed_mps;  ///< mean of both wheels
  double yaw_rate_degps;
};

struct Gnss {
  Time time;
  double east_m;
  double north_m;
  double sigma_east_m;
  bool has_heading;
};

/// What arrives at the appliance during the first 12 seconds, before its own checks.
struct Received {
  std::vector<Odometry> odometry;
  std::vector<Gnss> gnss;
  int wrong_crc = 0;
  int foreign = 0;
  int counter_jumps = 0;  ///< of the wheel speeds
};

/// Reads the vehicle's messages without the checks of the appliance.
class Reader {
 public:
  explicit Reader(const GeoOrigin& origin) : geo_({origin.latitude_deg, origin.longitude_deg}) {}

  void take(const can::ReceivedFrame& received) {
    const can::Frame& frame = received.frame;
    const can::Message* message = message_of(frame.id);
    if (message == nullptr) {
      ++received_.foreign;
      return;
    }
    const auto data_id = static_cast<uint8_t>(message->protection().data_id);
    if (!can::has_valid_crc_p02(frame, data_id)) ++received_.wrong_crc;
    const auto value = [&frame](const can::Signal& signal) {
      return can::decode(frame, signal).value_or(0.0);
    };
    if (message == &can::veh_wheel_speed::kMessage) {
      const int counter = frame.data[1] & 0x0F;
      if (last_counter_ >= 0 && counter != (last_counter_ + 1) % 16) ++received_.counter_jumps;
      last_counter_ = counter;
      speed_mps_ =
          0.5 * (value(can::veh_wheel_speed::kRearLeft) + value(can::veh_wheel_speed::kRearRight));
    } else if (message == &can::veh_yaw_rate::kMessage) {
      received_.odometry.push_back(
          {received.received, speed_mps_, value(can::veh_yaw_rate::kYawRate)});
    } else if (message == &can::veh_gnss_latitude::kMessage) {
      position_.latitude_deg = value(can::veh_gnss_latitude::kLatitude);
    } else if (message == &can::veh_gnss_longitude::kMessage) {
      position_.longitude_deg = value(can::veh_gnss_longitude::kLongitude);
      sigma_east_m_ = value(can::veh_gnss_longitude::kStdDev);
    } else if (message == &can::veh_gnss_heading::kMessage) {
      const Se2 pose = geo_.map_from_geodetic({position_, 0.0});
      const bool has_heading = can::decode(frame, can::veh_gnss_heading::kHeading).has_value();
      received_.gnss.push_back({received.received, pose.x_m, pose.y_m, sigma_east_m_, has_heading});
    }
  }

  const Received& received() const { return received_; }

 private:
  static const can::Message* message_of(uint32_t id) {
    for (const can::Message* message : can::kMessages) {
      if (message->sender == can::Sender::kVehicle && message->id(can::BaseIds()) == id) {
        return message;
      }
    }
    return nullptr;
  }

  can::GeoReference geo_;
  can::GeodeticPosition position_;
  double sigma_east_m_ = 0.0;
  double speed_mps_ = 0.0;
  int last_counter_ = -1;
  Received received_;
};

Received drive_with(const std::vector<sim::Fault>& faults) {
  const DriveConfig config = drive_with_faults(faults);
  const auto drive = SimulatedDrive::create(config);
  EXPECT_TRUE(drive) << drive.error().message;
  can::MockWire wire(4096);
  drivers::VirtualClock clock(kStart);
  FaultyBus bus(wire.connect(), drive->faults(), clock, kStart, config.simulation->seed);
  SimulatedVehicle vehicle(*drive, config.simulation->seed, config.can, wire.connect(), kStart);
  Reader reader(drive->map().origin);
  for (; clock.now() < kStart + std::chrono::seconds(12);
       clock.advance(std::chrono::milliseconds(10))) {
    vehicle.send_due(clock.now());
    while (const auto frame = bus.receive()) reader.take(*frame);
  }
  return reader.received();
}

const Received& healthy() {
  static const Received received = drive_with({});
  return received;
}

sim::Fault with(sim::Fault fault, double sim::FaultAmounts::*amount, double value) {
  fault.amounts.*amount = value;
  return fault;
}

TEST(InputFaults, AHealthyDriveHasAllSamples) {
  EXPECT_EQ(healthy().odometry.size(), 600U);
  EXPECT_EQ(healthy().gnss.size(), 120U);
}

TEST(InputFaults, GnssJumpsOnTheBusWhileItsFaultLasts) {
  const Received jumped = drive_with(
      {with(make_fault(FaultKind::kGnssJump, 4.0, 8.0), &sim::FaultAmounts::east_m, 20)});
  ASSERT_EQ(jumped.gnss.size(), healthy().gnss.size());
  for (size_t i = 0; i < jumped.gnss.size(); ++i) {
    const double expected_m = i >= 40 && i < 80 ? 20.0 : 0.0;
    EXPECT_NEAR(jumped.gnss[i].east_m - healthy().gnss[i].east_m, expected_m, 0.02) << i;
  }
}

TEST(InputFaults, GnssHeadingSigmaAndOutageReachTheBus) {
  const Received faulty = drive_with(
      {make_fault(FaultKind::kGnssNoHeading, 2.0, 4.0),
       with(make_fault(FaultKind::kGnssWrongSigma, 4.0, 6.0), &sim::FaultAmounts::factor, 0.1),
       make_fault(FaultKind::kGnssOutage, 6.0, 8.0)});
  ASSERT_EQ(faulty.gnss.size(), 100U);
  EXPECT_TRUE(faulty.gnss[19].has_heading);
  EXPECT_FALSE(faulty.gnss[20].has_heading);
  EXPECT_NEAR(faulty.gnss[45].sigma_east_m, 0.1 * healthy().gnss[45].sigma_east_m, 0.01);
  EXPECT_EQ(to_seconds(faulty.gnss[60].time - kStart), 8.0);
}

TEST(InputFaults, OdometryFaultsReachTheBusWithValidProtection) {
  const Received faulty = drive_with(
      {with(make_fault(FaultKind::kOdometryScaled, 2.0, 4.0), &sim::FaultAmounts::factor, 2.0),
       with(make_fault(FaultKind::kOdometrySlow, 4.0, 6.0), &sim::FaultAmounts::period_ms, 100.0),
       make_fault(FaultKind::kOdometryMissing, 6.0, 7.0),
       with(make_fault(FaultKind::kYawRateWrong, 8.0), &sim::FaultAmounts::yaw_rate_degps, 150.0)});
  EXPECT_NEAR(static_cast<double>(faulty.odometry.size()), 600.0 - 80.0 - 50.0, 1.0);
  ASSERT_GT(healthy().odometry[150].speed_mps, 1.0);
  EXPECT_NEAR(faulty.odometry[150].speed_mps, 2.0 * healthy().odometry[150].speed_mps, 0.01);
  EXPECT_NEAR(faulty.odometry.back().yaw_rate_degps, 150.0, 0.01);
  EXPECT_EQ(faulty.wrong_crc, 0);
  EXPECT_EQ(faulty.counter_jumps, 0) << "a silent sender does not count on";
}

TEST(InputFaults, AfterASuspensionTheVehicleIsElsewhere) {
  const Received suspended =
      drive_with({with(make_fault(FaultKind::kClockSuspend, 5.0), &sim::FaultAmounts::gap_s, 5.0)});
  ASSERT_EQ(suspended.gnss.size(), healthy().gnss.size());
  EXPECT_NEAR(suspended.gnss[49].east_m, healthy().gnss[49].east_m, 0.02);
  // The simulator plans a longer drive, which changes its poses by up to one step of the signal.
  for (size_t i = 50; i < 70; ++i) {
    EXPECT_NEAR(suspended.gnss[i].north_m, healthy().gnss[i + 50].north_m, 0.02);
    EXPECT_NEAR(suspended.gnss[i].east_m, healthy().gnss[i + 50].east_m, 0.02);
  }
}

TEST(InputFaults, ASuspensionThatIsSetLaterShortensTheDrive) {
  const auto drive = SimulatedDrive::create(drive_with_faults({}));
  ASSERT_TRUE(drive) << drive.error().message;
  const double length_s = drive->drive()->duration_s();
  EXPECT_GT(length_s, 20.0) << "it goes on beyond its configured duration";
  EXPECT_FALSE(drive->is_over(20.0));
  drive->faults()->add(
      with(make_fault(FaultKind::kClockSuspend, 5.0), &sim::FaultAmounts::gap_s, 15.0));
  EXPECT_FALSE(drive->is_over(length_s - 15.1));
  EXPECT_TRUE(drive->is_over(length_s - 14.9));
}

TEST(InputFaults, NothingArrivesInAGapOfTheClock) {
  const Received gap =
      drive_with({with(make_fault(FaultKind::kClockGap, 5.0), &sim::FaultAmounts::gap_s, 3.0)});
  EXPECT_EQ(gap.gnss.size(), 90U);
  EXPECT_EQ(gap.gnss[50].east_m, healthy().gnss[80].east_m);
}

TEST(InputFaults, WithAWallClockStepFramesAreStampedByTheControllersClock) {
  const Received stepped = drive_with(
      {with(make_fault(FaultKind::kWallClockStep, 5.0), &sim::FaultAmounts::step_s, 0.9)});
  ASSERT_EQ(stepped.odometry.size(), healthy().odometry.size());
  const auto early_by = [&](size_t index) {
    return healthy().odometry[index].time - stepped.odometry[index].time;
  };
  EXPECT_EQ(early_by(100), std::chrono::milliseconds(1)) << "read 1 ms after its arrival";
  EXPECT_GE(early_by(249), std::chrono::milliseconds(1));
  EXPECT_GE(early_by(599), std::chrono::milliseconds(1)) << "never from the future";
}

TEST(InputFaults, ABusThatIsOffOrAloneCarriesNothing) {
  const Received off = drive_with({make_fault(FaultKind::kBusOff, 2.0, 4.0)});
  EXPECT_EQ(off.gnss.size(), 100U);
  EXPECT_GT(off.counter_jumps, 0) << "the vehicle went on sending";
  const Received alone = drive_with({make_fault(FaultKind::kBusNoAcknowledge, 2.0, 4.0)});
  EXPECT_EQ(alone.gnss.size(), 100U);
}

TEST(InputFaults, AFloodLosesFramesAndFillsTheBus) {
  const Received flooded = drive_with({make_fault(FaultKind::kBusFlooded, 2.0)});
  EXPECT_LT(flooded.gnss.size(), 40U);
  EXPECT_GT(flooded.foreign, 3000);
}

TEST(InputFaults, ForgedOdometryHasARightCrc) {
  const Received forged = drive_with(
      {with(make_fault(FaultKind::kBusForged, 6.0, 8.0), &sim::FaultAmounts::speed_mps, 33.0)});
  EXPECT_EQ(forged.wrong_crc, 0);
  EXPECT_GT(forged.counter_jumps, 100);
  const auto is_forged = [](const Odometry& sample) {
    return std::abs(sample.speed_mps - 33.0) < 0.01;
  };
  EXPECT_EQ(std::ranges::count_if(forged.odometry, is_forged), 100);
  EXPECT_EQ(std::ranges::count_if(healthy().odometry, is_forged), 0);
}

TEST(InputFaults, AReplayRepeatsOldFrames) {
  const Received replayed = drive_with(
      {with(make_fault(FaultKind::kBusReplayed, 6.0, 8.0), &sim::FaultAmounts::age_s, 4.0)});
  EXPECT_GT(replayed.gnss.size(), healthy().gnss.size());
  const auto repeats = [&](const Gnss& sample) {
    return sample.east_m == healthy().gnss[25].east_m;
  };
  EXPECT_EQ(std::ranges::count_if(replayed.gnss, repeats), 2);
}

TEST(FaultyBusTest, OldFramesReachTheWireAfterALackOfAcknowledgement) {
  const auto faults = std::make_shared<sim::FaultBoard>(std::vector{with(
      make_fault(FaultKind::kBusNoAcknowledge, 1.0, 2.0), &sim::FaultAmounts::stale_frames, 3.0)});
  can::MockWire wire;
  drivers::VirtualClock clock(kStart);
  FaultyBus bus(wire.connect(), faults, clock, kStart, 1);
  const auto other = wire.connect();
  const auto send = [&](uint32_t id, double time_s) {
    return bus.send({.id = id, .length = 1}, kStart + from_seconds(time_s));
  };
  EXPECT_EQ(send(1, 0.5), can::SendResult::kSent);
  for (uint32_t id = 2; id < 7; ++id) send(id, 1.5);
  EXPECT_EQ(other->receive()->frame.id, 1U);
  EXPECT_FALSE(other->receive());
  clock.advance(std::chrono::milliseconds(1500));
  EXPECT_EQ(bus.condition().state, can::BusState::kPassive);
  EXPECT_TRUE(bus.condition().has(can::BusFault::kNoAcknowledge));
  EXPECT_EQ(send(9, 2.0), can::SendResult::kSent);
  for (const uint32_t id : {2U, 3U, 4U, 9U}) EXPECT_EQ(other->receive()->frame.id, id);
  EXPECT_EQ(bus.counters().send_expired, 2U);
}

TEST(InputFaults, TheApplianceGetsTheFaultyMapAndTheWorldStays) {
  const auto drive = SimulatedDrive::create(drive_with_faults(
      {with(make_fault(FaultKind::kMapShifted), &sim::FaultAmounts::north_m, 3.0)}));
  const auto good = SimulatedDrive::create(drive_with_faults({}));
  ASSERT_TRUE(drive && good);
  EXPECT_NEAR(drive->map().elements[0].points[0].y() - good->map().elements[0].points[0].y(), 3.0,
              1e-9);
  EXPECT_EQ(drive->truth_at(5.0).y_m, good->truth_at(5.0).y_m);
}

}  // namespace
}  // namespace bevloc::evaluation
