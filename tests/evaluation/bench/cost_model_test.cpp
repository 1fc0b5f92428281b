#include "evaluation/bench/cost_model.h"

#include <gtest/gtest.h>

namespace bevloc::bench {
namespace {

const MachinePeak kPeak{400e9, 300e9, 10e9};

TEST(CostModel, ThePeakIsTheBetterOfTheTwo) {
  EXPECT_DOUBLE_EQ(kPeak.macs_per_s(), 400e9);
  EXPECT_DOUBLE_EQ((MachinePeak{1e9, 2e9, 0.0}.macs_per_s()), 2e9);
}

TEST(CostModel, IdealTimeIsTheLongerOfMultiplyingAndCopying) {
  EXPECT_DOUBLE_EQ(ideal_s({0.8e9, 1e6}, kPeak), 2e-3);   // 0.1 ms of copying
  EXPECT_DOUBLE_EQ(ideal_s({0.04e9, 5e6}, kPeak), 5e-4);  // 0.1 ms of multiplying
  EXPECT_DOUBLE_EQ(ideal_s({}, kPeak), 0.0);
}

TEST(CostModel, WithoutAPeakOnlyCopyingCounts) {
  EXPECT_DOUBLE_EQ(ideal_s({0.8e9, 1e6}, {0.0, 0.0, 10e9}), 1e-4);
}

TEST(CostModel, SummaryUsesNearestRank) {
  std::vector<double> times_ms;
  for (int i = 200; i >= 1; --i) times_ms.push_back(i);
  const TimeSummary summary = summarize(times_ms);
  EXPECT_DOUBLE_EQ(summary.p50_ms, 100.0);
  EXPECT_DOUBLE_EQ(summary.p90_ms, 180.0);
  EXPECT_DOUBLE_EQ(summary.p99_ms, 198.0);
  EXPECT_DOUBLE_EQ(summary.max_ms, 200.0);
}

TEST(CostModel, MedianOfAnEvenNumberIsTheLower) {
  EXPECT_DOUBLE_EQ(summarize({4.0, 1.0, 3.0, 2.0}).p50_ms, 2.0);
}

TEST(CostModel, SummarizesOneTimeAndNone) {
  EXPECT_DOUBLE_EQ(summarize({3.0}).p99_ms, 3.0);
  EXPECT_DOUBLE_EQ(summarize({3.0}).p50_ms, 3.0);
  EXPECT_DOUBLE_EQ(summarize({}).max_ms, 0.0);
}

}  // namespace
}  // namespace bevloc::bench
