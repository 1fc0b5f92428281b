#include "evaluation/drive/judge.h"

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"
#include "evaluation/drive/simulated_drive.h"
#include "sim/faults/fault_table.h"
#include "tests/evaluation/drive/drive_with_faults.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kJudgedStart{seconds(100)};
constexpr Time kGapStart = kJudgedStart + seconds(5);
constexpr Duration kGapLength = seconds(3);

/// Drives 20 s, with a fault of the clock after 5 s. A localizer on the bus sends the true poses.
std::vector<JudgedPose> judged_with(sim::FaultKind kind) {
  sim::Fault fault = sim::make_fault(kind, to_seconds(kGapStart - kJudgedStart));
  fault.amounts.gap_s = to_seconds(kGapLength);
  const DriveConfig config = test::drive_with_faults({fault});
  const auto drive = SimulatedDrive::create(config);
  EXPECT_TRUE(drive) << drive.error().message;
  const GeoOrigin& origin = drive->map().origin;
  can::MockWire wire;
  const auto localizer_bus = wire.connect();
  can::PosePublisher localizer(*localizer_bus,
                               {.map_origin = {origin.latitude_deg, origin.longitude_deg}});
  const test::TemporaryFolder folder;
  const auto judge = Judge::create(
      wire.connect(), config.can, origin,
      [&drive](double time_s) { return drive->truth_at(time_s); }, {kJudgedStart, kJudgedStart},
      (folder / "can.log").string());
  EXPECT_TRUE(judge) << judge.error().message;
  SimulatedVehicle vehicle(*drive, config.simulation->seed, config.can, wire.connect(),
                           kJudgedStart);
  bool had_gap = false;
  for (Time now = kJudgedStart; now < kJudgedStart + seconds(20); now += milliseconds(10)) {
    if (now >= kGapStart && !had_gap) {
      had_gap = true;
      if (kind == sim::FaultKind::kClockGap) now += kGapLength;
      (*judge)->note_gap(now);
    }
    vehicle.send_due(now);
    can::PoseReport report;
    report.status.state = HealthState::kTracking;
    report.capture_time = now - milliseconds(60);
    report.pose_time = now;
    report.map_from_vehicle = drive->truth_at(to_seconds(now - kJudgedStart));
    report.covariance = Eigen::Matrix3d::Identity() * 0.01;
    localizer.publish(report, now);
    (*judge)->step(Duration::zero());
  }
  EXPECT_TRUE((*judge)->finish());
  return (*judge)->poses();
}

class JudgeAfterAGap : public testing::TestWithParam<sim::FaultKind> {};

INSTANTIATE_TEST_SUITE_P(Kinds, JudgeAfterAGap,
                         testing::Values(sim::FaultKind::kClockGap, sim::FaultKind::kClockSuspend));

TEST_P(JudgeAfterAGap, ThePriorIsWhereTheVehicleIs) {
  const std::vector<JudgedPose> poses = judged_with(GetParam());
  double driven_unseen_m = 0.0;
  int after = 0;
  ErrorStatistics prior;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector2d step = poses[i].truth.translation() - poses[i - 1].truth.translation();
    driven_unseen_m = std::max(driven_unseen_m, step.norm());
    if (poses[i].time_s <= to_seconds(kGapStart - kJudgedStart)) continue;
    ++after;
    prior.add(pose_error(poses[i].truth, poses[i].prior));
  }
  ASSERT_GT(driven_unseen_m, 10.0) << "the vehicle drives during the gap";
  EXPECT_GT(after, 100);
  EXPECT_LT(prior.summary().longitudinal_m.mae, 3.0);
  EXPECT_LT(prior.summary().lateral_m.mae, 3.0);
}

}  // namespace
}  // namespace bevloc::evaluation
