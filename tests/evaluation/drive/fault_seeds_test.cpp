// The faults that are drawn at random differ from drive to drive.
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/drive/faulty_bus.h"
#include "evaluation/drive/simulated_drive.h"
#include "sim/faults/fault_table.h"
#include "tests/drivers/mock/mock_rig.h"

namespace bevloc::evaluation {
namespace {

constexpr Time kSeededStart{std::chrono::seconds(20)};

/// Which of the frames that the appliance sends and gets are lost in a flood.
std::vector<bool> losses_of(uint64_t seed) {
  sim::Fault flood = sim::make_fault(sim::FaultKind::kBusFlooded);
  flood.amounts.loss = 0.5;
  const auto faults = std::make_shared<sim::FaultBoard>(std::vector{flood});
  can::MockWire wire;
  const drivers::VirtualClock clock(kSeededStart);
  FaultyBus bus(wire.connect(), faults, clock, kSeededStart, seed);
  const auto other = wire.connect();
  std::vector<bool> losses;
  for (uint32_t id = 1; id <= 64; ++id) {
    losses.push_back(bus.send({.id = id, .length = 1}, kSeededStart) != can::SendResult::kSent);
    other->send({.id = id, .length = 1}, kSeededStart);
    losses.push_back(!bus.receive());
  }
  return losses;
}

TEST(FaultSeeds, AFloodTakesOtherFramesInAnotherDrive) {
  EXPECT_EQ(losses_of(1), losses_of(1));
  EXPECT_NE(losses_of(1), losses_of(2));
}

/// The first picture of the front camera, all of whose light is gone.
std::vector<uint8_t> dark_picture(uint64_t seed) {
  DriveConfig config;
  config.cameras.rate_hz = 10.0;
  config.simulation.emplace();
  config.simulation->seed = seed;
  config.simulation->town_seed = 2005;
  config.simulation->duration_s = 5.0;
  config.simulation->faults = {sim::make_fault(sim::FaultKind::kCameraDark)};
  const auto drive = SimulatedDrive::create(config);
  EXPECT_TRUE(drive) << drive.error().message;
  drivers::VirtualClock clock(kSeededStart);
  const Rig rig = drivers::small_front_camera().true_rig;
  const auto cameras = drive->make_cameras(config, rig, clock, kSeededStart);
  drivers::Camera& front = *cameras[1];
  EXPECT_TRUE(front.start());
  drivers::Frame frame;
  EXPECT_EQ(front.next_frame(std::chrono::seconds(1), frame), drivers::FrameEvent::kFrame);
  const RgbView view = frame.pixels();
  return {view.data, view.data + view.stride_bytes * view.height};
}

TEST(FaultSeeds, DarkPicturesHaveOtherNoiseInAnotherDrive) {
  EXPECT_EQ(dark_picture(2005), dark_picture(2005));
  EXPECT_NE(dark_picture(2005), dark_picture(2006));
}

}  // namespace
}  // namespace bevloc::evaluation
