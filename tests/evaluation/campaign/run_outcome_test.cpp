#include "evaluation/campaign/run_outcome.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc::evaluation {
namespace {

constexpr double kCycle_s = 0.01;
constexpr FaultTime kFault{10.0, 15.0};

JudgedCycle valid_cycle(double time_s, const Eigen::Vector3d& error) {
  JudgedCycle cycle;
  cycle.time_s = time_s;
  cycle.state = HealthState::kTracking;
  cycle.pose = JudgedError{
      .error = error, .sigma = {0.1, 0.05, radians(0.2)}, .protection = {0.5, 0.25, radians(1.0)}};
  return cycle;
}

JudgedCycle lost_cycle(double time_s) {
  JudgedCycle cycle;
  cycle.time_s = time_s;
  cycle.state = HealthState::kLost;
  return cycle;
}

/// Feeds the cycles of [from_s, until_s).
template <typename MakeCycle>
void feed(RunJudge& judge, double from_s, double until_s, const MakeCycle& make) {
  const auto first = static_cast<int>(from_s / kCycle_s + 0.5);
  const auto last = static_cast<int>(until_s / kCycle_s + 0.5);
  for (int i = first; i < last; ++i) judge.add(make(i * kCycle_s));
}

const auto kRight = [](double time_s) { return valid_cycle(time_s, {0.01, 0.0, 0.0}); };
const auto kWrong = [](double time_s) { return valid_cycle(time_s, {0.0, -0.6, 0.0}); };

TEST(RunJudgeTest, MeasuresHowLongWrongPosesWereValid) {
  RunJudge judge(kFault, Why::kGnssContradicts);
  feed(judge, 0.0, 10.0, kRight);
  feed(judge, 10.0, 11.5, kWrong);
  feed(judge, 11.5, 14.0, lost_cycle);
  feed(judge, 14.0, 20.0, kRight);
  const RunOutcome outcome = judge.outcome();
  EXPECT_NEAR(outcome.beyond_alert_s(), 1.5, 1e-9);
  EXPECT_NEAR(outcome.worst.y(), 0.6, 1e-9);
  EXPECT_EQ(outcome.detected_by, "not valid");
  EXPECT_NEAR(*outcome.detection_s, 1.5, 1e-9);
  EXPECT_NEAR(*outcome.recovery_s, 0.0, 1e-9);
  EXPECT_EQ(outcome.lost, 1);
  EXPECT_EQ(outcome.false_lost, 0);
  EXPECT_NEAR(outcome.valid_share(), 17.5 / 20.0, 1e-3);
}

TEST(RunJudgeTest, CountsOnlyAReasonThatNamesTheFaultAsDetection) {
  RunJudge judge(kFault, Why::kGnssContradicts);
  feed(judge, 0.0, 10.0, kRight);
  feed(judge, 10.0, 12.0, [](double time_s) {
    JudgedCycle cycle = kRight(time_s);
    cycle.why = Why::kMatchRejected;
    return cycle;
  });
  feed(judge, 12.0, 13.0, [](double time_s) {
    JudgedCycle cycle = kRight(time_s);
    cycle.why = Why::kGnssContradicts | Why::kMatchRejected;
    return cycle;
  });
  const RunOutcome outcome = judge.outcome();
  EXPECT_EQ(outcome.detected_by, "GnssContradicts");
  EXPECT_NEAR(*outcome.detection_s, 2.0, 1e-9);
  EXPECT_EQ(outcome.timeline.size(), 3);
}

TEST(RunJudgeTest, APoseThatWasLostBeforeTheFaultDetectsNothing) {
  RunJudge judge(kFault, Why::kGnssContradicts);
  feed(judge, 0.0, 9.0, kRight);
  feed(judge, 9.0, 12.0, lost_cycle);
  feed(judge, 12.0, 20.0, kRight);
  EXPECT_FALSE(judge.outcome().detection_s);
  EXPECT_EQ(judge.outcome().detected_by, "");
  EXPECT_EQ(judge.outcome().false_lost, 1);
}

TEST(RunJudgeTest, DoesNotCountAReasonThatWasThereBeforeTheFault) {
  const auto degraded = [](double time_s) {
    JudgedCycle cycle = kRight(time_s);
    cycle.why = Why::kGnssContradicts;
    return cycle;
  };
  RunJudge judge(kFault, Why::kGnssContradicts);
  feed(judge, 0.0, 20.0, degraded);
  EXPECT_EQ(judge.outcome().detected_by, "");
  EXPECT_EQ(judge.outcome().detection_s, std::nullopt);
}

TEST(RunJudgeTest, CountsAReasonThatWasGoneAndComesBack) {
  RunJudge judge({0.0, 15.0}, Why::kCameraMissing);
  const auto missing = [](double time_s) {
    JudgedCycle cycle = lost_cycle(time_s);
    cycle.why = Why::kCameraMissing;
    return cycle;
  };
  feed(judge, 0.0, 0.1, missing);  // nothing has arrived yet
  feed(judge, 0.1, 2.0, lost_cycle);
  feed(judge, 2.0, 3.0, missing);
  EXPECT_EQ(judge.outcome().detected_by, "CameraMissing");
  EXPECT_NEAR(*judge.outcome().detection_s, 2.0, 1e-9);
}

TEST(RunJudgeTest, TellsALostPoseFromOneThatWasNeverValid) {
  RunJudge never({0.0, 15.0}, {});
  feed(never, 0.0, 10.0, lost_cycle);
  EXPECT_EQ(never.outcome().detected_by, "never valid");
  EXPECT_FALSE(never.outcome().detection_s) << "nothing was detected at any time";
  RunJudge later({0.0, 15.0}, {});
  feed(later, 0.0, 2.0, lost_cycle);
  feed(later, 2.0, 5.0, kWrong);
  EXPECT_EQ(later.outcome().detected_by, "");
  feed(later, 5.0, 6.0, lost_cycle);
  EXPECT_EQ(later.outcome().detected_by, "not valid");
  EXPECT_NEAR(*later.outcome().detection_s, 5.0, 1e-9);
}

TEST(RunJudgeTest, ASilentApplianceIsNotValid) {
  RunJudge judge(kFault, Why::kClockGap);
  feed(judge, 0.0, 10.0, kRight);
  feed(judge, 13.0, 20.0, kRight);
  const RunOutcome outcome = judge.outcome();
  EXPECT_EQ(outcome.cycles, 2000U);
  EXPECT_EQ(outcome.valid, 1700U);
  EXPECT_EQ(outcome.lost, 1);
  EXPECT_EQ(outcome.false_lost, 0);
  EXPECT_EQ(outcome.detected_by, "not valid");
  EXPECT_NEAR(*outcome.detection_s, 0.0, 1e-9);
  EXPECT_EQ(outcome.timeline.size(), 1U) << "it said nothing new";
}

TEST(RunJudgeTest, AnApplianceThatIsSilentBeforeItsFirstPoseLosesNothing) {
  RunJudge judge(kFault, {});
  feed(judge, 0.0, 1.0, lost_cycle);
  feed(judge, 4.0, 20.0, kRight);
  EXPECT_EQ(judge.outcome().cycles, 1600U);
  EXPECT_EQ(judge.outcome().lost, 0);
}

TEST(RunJudgeTest, CallsItRecoveredOnceThePoseStaysRight) {
  RunJudge judge(kFault, {});
  feed(judge, 0.0, 10.0, kRight);
  feed(judge, 10.0, 16.0, lost_cycle);
  feed(judge, 16.0, 16.5, kRight);
  feed(judge, 16.5, 17.0, kWrong);
  feed(judge, 17.0, 20.0, kRight);
  EXPECT_NEAR(*judge.outcome().recovery_s, 2.0, 1e-9);
}

TEST(RunJudgeTest, DoesNotCallARunRecoveredThatStaysLost) {
  RunJudge judge(kFault, {});
  feed(judge, 0.0, 10.0, kRight);
  feed(judge, 10.0, 20.0, lost_cycle);
  EXPECT_EQ(judge.outcome().recovery_s, std::nullopt);
}

TEST(RunJudgeTest, CountsALostPoseBeforeTheFaultAsFalse) {
  RunJudge judge(kFault, {});
  feed(judge, 0.0, 5.0, kRight);
  feed(judge, 5.0, 6.0, lost_cycle);
  feed(judge, 6.0, 10.0, kRight);
  EXPECT_EQ(judge.outcome().false_lost, 1);
}

TEST(RunJudgeTest, SeparatesMisleadingFromHazardousPoses) {
  RunJudge judge(kFault, {});
  judge.add(valid_cycle(0.0, {0.0, 0.2, 0.0}));  // within the protection level
  judge.add(valid_cycle(0.1, {0.0, 0.3, 0.0}));  // beyond it: misleading
  judge.add(valid_cycle(0.2, {0.0, 0.6, 0.0}));  // and beyond the alert limit: hazardous
  const RunOutcome outcome = judge.outcome();
  EXPECT_EQ(outcome.protection.misleading, (PoseCounts{0, 2, 0}));
  EXPECT_EQ(outcome.protection.hazardous, (PoseCounts{0, 1, 0}));
  EXPECT_EQ(outcome.protection.available, (PoseCounts{3, 3, 3}));
  EXPECT_EQ(outcome.within_sigma[0], (PoseCounts{3, 0, 3}));
  EXPECT_EQ(outcome.within_sigma[2], (PoseCounts{3, 0, 3}));
}

TEST(RunJudgeTest, DoesNotCountAPoseWithoutAProtectionLevelAsAvailable) {
  RunJudge judge(kFault, {});
  JudgedCycle cycle = valid_cycle(0.0, {0.0, 0.6, 0.0});
  cycle.pose->protection.setConstant(std::numeric_limits<double>::quiet_NaN());
  judge.add(cycle);
  const RunOutcome outcome = judge.outcome();
  EXPECT_EQ(outcome.valid, 1);
  EXPECT_EQ(outcome.protection.with_level, (PoseCounts{0, 0, 0}));
  EXPECT_EQ(outcome.protection.available, (PoseCounts{0, 0, 0}));
  EXPECT_EQ(outcome.protection.misleading, (PoseCounts{0, 0, 0}));
}

TEST(NamesOfTest, AreThoseOfTheBus) {
  EXPECT_EQ(names_of(Why::kGnssMissing | Why::kClockGap), "GnssMissing+ClockGap");
  EXPECT_EQ(names_of({}), "");
}

}  // namespace
}  // namespace bevloc::evaluation
