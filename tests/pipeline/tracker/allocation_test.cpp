// The tracker may not allocate once it is made: this program counts every allocation.
#include <gtest/gtest.h>

#include "pipeline/tracker/tracker.h"
#include "tests/pipeline/tracker/simulated_vehicle.h"
#include "tests/support/allocation_counter.h"

namespace bevloc {
namespace {

TEST(AllocationTest, NoneWhileDriving) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 1);
  EXPECT_GT(test::allocation_count(), 0);
  const int before = test::allocation_count();
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
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace bevloc
