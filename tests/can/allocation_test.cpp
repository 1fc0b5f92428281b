// Tests that the bus does not allocate in the steady state.
#include <variant>

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/messages/vehicle_encoder.h"
#include "can/messages/vehicle_input.h"
#include "can/publisher/pose_publisher.h"
#include "evaluation/bench/allocation_count.h"

namespace bevloc::can {
namespace {

TEST(Allocation, NoneInOneSecondOfTheBus) {
  constexpr GeodeticPosition kOrigin{49.0, 8.4};
  MockWire wire;
  const auto localizer = wire.connect();
  const auto vehicle = wire.connect();
  PosePublisher publisher(*localizer, {.map_origin = kOrigin});
  VehicleEncoder encoder(BaseIds{}, kOrigin, 1.6);
  VehicleInput input(BaseIds{}, kOrigin, 1.6);
  PoseReport report;
  report.status.state = HealthState::kTracking;
  report.map_from_vehicle = {1.0, 2.0, 3.0};
  report.covariance.setIdentity();

  int samples = 0;
  const uint64_t before = bench::allocation_count();
  for (int cycle = 0; cycle < 100; ++cycle) {
    const Time now(std::chrono::milliseconds(10 * cycle + 1000));
    report.capture_time = report.pose_time = now;
    publisher.publish(report, now);
    for (const Frame& frame : encoder.odometry({now, 10.0, 0.1})) vehicle->send(frame, now);
    for (const Frame& frame : encoder.gnss({now, 3.0, 4.0, 1.0, 1.0, {}})) {
      vehicle->send(frame, now);
    }
    while (const auto received = localizer->receive()) samples += bool{input.accept(*received)};
    while (vehicle->receive()) {
    }
  }
  EXPECT_EQ(bench::allocation_count() - before, 0U);
  EXPECT_EQ(samples, 200);
}

}  // namespace
}  // namespace bevloc::can
