// The tracker may not allocate once it is made: this program counts every allocation.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "pipeline/tracker/tracker.h"
#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace {
std::atomic<int> allocations = 0;
}  // namespace

void* operator new(size_t size) {
  ++allocations;
  void* memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}

namespace bevloc {
namespace {

TEST(AllocationTest, NoneWhileDriving) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 1);
  EXPECT_GT(allocations, 0);
  const int before = allocations;
  for (int i = 0; i < 400; ++i) {
    const double time_s = 0.02 * i;
    vehicle.drive_to(time_s);
    tracker.add_odometry(vehicle.odometry(time_s));
    if (i % 10 == 0) tracker.add_gnss(vehicle.gnss());
    const Se2 prior = tracker.pose_at(at_s(time_s))->map_from_vehicle;
    tracker.add_correction(at_s(time_s), prior, vehicle.correction_from(prior));
    tracker.pose_at(at_s(time_s - 0.05));
  }
  tracker.widen();
  tracker.reset();
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace bevloc
