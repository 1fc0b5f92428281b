#include "evaluation/drive/reference_receiver.h"

#include <gtest/gtest.h>

#include "evaluation/drive/simulated_drive.h"
#include "sim/faults/fault_table.h"
#include "tests/evaluation/drive/drive_with_faults.h"

namespace bevloc::evaluation {
namespace {

constexpr Time kReferenceStart{std::chrono::seconds(100)};
/// Far beyond the noise of the receiver.
constexpr double kNoise_m = 0.15;
constexpr double kSuspended_s = 3.0;

TEST(ReferenceReceiverTest, AfterASuspensionItsPosesHaveTheTimesOfTheAppliance) {
  sim::Fault suspend = sim::make_fault(sim::FaultKind::kClockSuspend, 5.0);
  suspend.amounts.gap_s = kSuspended_s;
  const auto drive = SimulatedDrive::create(test::drive_with_faults({suspend}));
  ASSERT_TRUE(drive) << drive.error().message;
  ASSERT_GT((drive->truth_at(5.1).translation() - drive->truth_at(4.9).translation()).norm(), 10.0);
  const ReferenceTrajectory reference = drive->reference(7, kReferenceStart);
  for (const double time_s : {1.0, 4.9, 5.1, 12.0, 20.0}) {
    const auto pose = reference.at(kReferenceStart + from_seconds(time_s));
    ASSERT_TRUE(pose) << time_s;
    const Se2 truth = drive->truth_at(time_s);
    EXPECT_LT((pose->translation() - truth.translation()).norm(), kNoise_m) << time_s;
    EXPECT_NEAR(wrap_angle(pose->yaw_rad - truth.yaw_rad), 0.0, radians(0.5)) << time_s;
  }
  EXPECT_NEAR(to_seconds(reference.poses().back().time - kReferenceStart),
              drive->drive()->duration_s() - kSuspended_s, 0.1);
}

TEST(ReferenceReceiverTest, WithoutASuspensionTheReferenceIsThatOfTheDrive) {
  const auto drive = SimulatedDrive::create(test::drive_with_faults({}));
  ASSERT_TRUE(drive) << drive.error().message;
  const auto of_drive =
      receive_reference(*drive->drive(), sim::seed_for(7, "reference"), kReferenceStart);
  EXPECT_EQ(drive->reference(7, kReferenceStart).to_csv(), of_drive.to_csv());
}

}  // namespace
}  // namespace bevloc::evaluation
