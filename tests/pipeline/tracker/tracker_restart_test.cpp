// What a tracker answers after it has started again.
#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

TEST(TrackerRestartTest, AMeasurementFromBeforeTheFirstPoseIsNotTooOld) {
  Tracker tracker;
  SimulatedVehicle vehicle({}, 11);
  Drive{}.run(tracker, vehicle, 5.0);
  tracker.restart();
  const Se2 prior = vehicle.drive_to(5.0);
  const SolverResult late = vehicle.correction_from(prior);
  const GnssSample late_gnss = vehicle.gnss();
  vehicle.drive_to(5.05);
  EXPECT_EQ(tracker.add_odometry(vehicle.odometry(5.05)), TrackerUpdate::kAccepted);
  EXPECT_EQ(tracker.add_gnss(vehicle.gnss()), TrackerUpdate::kAccepted);
  EXPECT_EQ(tracker.add_correction(at_s(5.0), prior, late), TrackerUpdate::kNotInitialised);
  EXPECT_EQ(tracker.add_gnss(late_gnss), TrackerUpdate::kNotInitialised);
  // Later, the first pose is older than the history, and so are measurements after it.
  for (int i = 1; i <= 200; ++i) {
    const double time_s = 5.05 + kOdometryStep_s * i;
    vehicle.drive_to(time_s);
    tracker.add_odometry(vehicle.odometry(time_s));
  }
  EXPECT_EQ(tracker.add_correction(at_s(5.1), prior, late), TrackerUpdate::kTooOld);
}

}  // namespace
}  // namespace bevloc
