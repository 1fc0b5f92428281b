// The steady state of the bus allocates nothing.
#include <cstdlib>
#include <new>
#include <variant>

#include <gtest/gtest.h>

#include "can/mock_bus.h"
#include "can/pose_publisher.h"
#include "can/vehicle_encoder.h"
#include "can/vehicle_input.h"

namespace {
thread_local int allocations = 0;
}

/// Not inlined: else the compiler sees malloc() and free() in the tests and takes them for
/// mismatches.
[[gnu::noinline]] void* operator new(size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}

namespace bevloc::can {
namespace {

TEST(Allocation, NoneInOneSecondOfTheBus) {
  constexpr GeodeticPosition kOrigin{49.0, 8.4};
  MockWire wire;
  const auto localizer = wire.connect();
  const auto vehicle = wire.connect();
  PosePublisher publisher(*localizer, {.map_origin = kOrigin});
  VehicleEncoder encoder(BaseIds{}, kOrigin, 1.6);
  VehicleInput input(BaseIds{}, kOrigin);
  PoseReport report;
  report.status.state = LocalizerState::kTracking;
  report.map_from_vehicle = {1.0, 2.0, 3.0};
  report.covariance.setIdentity();

  int samples = 0;
  const int before = allocations;
  for (int cycle = 0; cycle < 100; ++cycle) {
    const Time now(std::chrono::milliseconds(10 * cycle + 1000));
    report.capture_time = report.pose_time = now;
    publisher.publish(report, now);
    for (const Frame& frame : encoder.odometry({now, 10.0, 0.1})) vehicle->send(frame, now);
    for (const Frame& frame : encoder.gnss({now, 3.0, 4.0, 1.0, 1.0, {}})) {
      vehicle->send(frame, now);
    }
    while (const auto received = localizer->receive())
      samples += input.accept(*received).index() != 0;
    while (vehicle->receive()) {
    }
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_EQ(samples, 200);
}

}  // namespace
}  // namespace bevloc::can
