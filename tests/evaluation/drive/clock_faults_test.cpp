#include "evaluation/drive/clock_faults.h"

#include <limits>

#include <gtest/gtest.h>

#include "sim/faults/fault_table.h"

namespace bevloc::evaluation {
namespace {

ClockFaults clock_faults_with(sim::FaultKind kind, double gap_s,
                              double until_s = std::numeric_limits<double>::infinity()) {
  sim::Fault fault = sim::make_fault(kind, 5.0, until_s);
  fault.amounts.gap_s = gap_s;
  return ClockFaults(std::make_shared<sim::FaultBoard>(std::vector{fault}));
}

TEST(ClockFaultsTest, JumpsOverAGapOnce) {
  ClockFaults faults = clock_faults_with(sim::FaultKind::kClockGap, 3.0);
  EXPECT_EQ(faults.gap_due(4.9), Duration::zero());
  EXPECT_EQ(faults.gap_due(5.1), from_seconds(8.0 - 5.1)) << "the gap ends 3 s after its start";
  EXPECT_EQ(faults.gap_due(8.0), Duration::zero());
  EXPECT_EQ(faults.suspension_due(8.0), Duration::zero());
}

TEST(ClockFaultsTest, AFaultThatEndedBetweenTwoLooksHappensOnce) {
  ClockFaults faults = clock_faults_with(sim::FaultKind::kClockGap, 3.0, 5.05);
  EXPECT_EQ(faults.gap_due(4.98), Duration::zero());
  EXPECT_EQ(faults.gap_due(5.08), from_seconds(8.0 - 5.08));
  EXPECT_EQ(faults.gap_due(8.0), Duration::zero());
  ClockFaults of_no_length = clock_faults_with(sim::FaultKind::kClockGap, 3.0, 5.0);
  EXPECT_EQ(of_no_length.gap_due(5.08), Duration::zero());
}

TEST(ClockFaultsTest, TellsASuspensionOnce) {
  ClockFaults faults = clock_faults_with(sim::FaultKind::kClockSuspend, 3.0);
  EXPECT_EQ(faults.suspension_due(4.99), Duration::zero());
  EXPECT_NEAR(to_seconds(faults.suspension_due(5.0)), 3.0, 1e-6);
  EXPECT_LT(to_seconds(faults.suspension_due(5.01)), 1e-6);
  EXPECT_EQ(faults.gap_due(5.0), Duration::zero());
}

}  // namespace
}  // namespace bevloc::evaluation
