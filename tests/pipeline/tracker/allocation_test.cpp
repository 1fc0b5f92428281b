// Counts allocations: the tracker and the pose trail allocate in their constructors only.
#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "pipeline/tracker/gnss_monitor.h"
#include "pipeline/tracker/pose_trail.h"
#include "pipeline/tracker/tracker.h"
#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

TEST(TrackerAllocationTest, NoneWhileDriving) {
  Tracker tracker;
  PoseTrail trail;
  GnssMonitor monitor;
  SimulatedVehicle vehicle({}, 1);
  EXPECT_GT(bench::allocation_count(), 0U);
  const uint64_t before = bench::allocation_count();
  for (int i = 0; i < 400; ++i) {
    const double time_s = 0.02 * i;
    vehicle.drive_to(time_s);
    tracker.add_odometry(vehicle.odometry(time_s));
    if (i % 10 == 0) tracker.add_gnss(vehicle.gnss());
    const TrackedPose pose = *tracker.pose_at(at_s(time_s));
    if (i % 10 == 0) monitor.add(vehicle.gnss(), pose);
    trail.add(pose);
    const Se2 prior = *trail.at(at_s(time_s));
    tracker.add_correction(at_s(time_s), prior, vehicle.correction_from(prior));
    tracker.pose_at(at_s(time_s - 0.05));
  }
  tracker.widen();
  tracker.reset();
  EXPECT_EQ(bench::allocation_count(), before);
}

}  // namespace
}  // namespace bevloc
