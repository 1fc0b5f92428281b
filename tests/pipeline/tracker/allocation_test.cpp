// Counts allocations: the tracker and the pose trail allocate in their constructors only.
#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "pipeline/tracker/pose_estimator.h"
#include "pipeline/tracker/pose_trail.h"
#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

TEST(TrackerAllocationTest, NoneWhileDriving) {
  PoseEstimator estimator{TrackerParameters()};
  PoseTrail trail;
  SimulatedVehicle vehicle({}, 1);
  EXPECT_GT(bench::allocation_count(), 0U);
  const uint64_t before = bench::allocation_count();
  for (int i = 0; i < 400; ++i) {
    const double time_s = 0.02 * i;
    vehicle.drive_to(time_s);
    estimator.add(vehicle.odometry(time_s));
    if (i % 10 == 0) estimator.add(vehicle.gnss());
    const TrackedPose pose = *estimator.pose_at(at_s(time_s));
    trail.add(pose);
    const Se2 prior = *trail.at(at_s(time_s));
    estimator.add_match(at_s(time_s), prior, vehicle.correction_from(prior));
    estimator.judge(at_s(time_s), true);
    estimator.pose_at(at_s(time_s - 0.05));
  }
  estimator.restart();
  EXPECT_EQ(bench::allocation_count(), before);
}

}  // namespace
}  // namespace bevloc
