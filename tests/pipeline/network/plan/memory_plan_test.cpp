#include "pipeline/network/plan/memory_plan.h"

#include <gtest/gtest.h>

#include "tests/pipeline/network/model_inputs.h"

namespace bevloc::nn {
namespace {

TEST(MemoryPlan, SharesMemoryBetweenBuffersThatNeverMeet) {
  const std::vector<Lifetime> buffers{{1000, 0, 1}, {500, 2, 3}, {1000, 4, 5}};
  const MemoryPlan plan = plan_memory(buffers);
  EXPECT_EQ(plan.offsets, (std::vector<size_t>{0, 0, 0}));
  EXPECT_EQ(plan.total_bytes, 1024U);
}

TEST(MemoryPlan, KeepsContemporariesApart) {
  const std::vector<Lifetime> buffers{{64, 0, 1}, {64, 1, 2}};
  const MemoryPlan plan = plan_memory(buffers);
  EXPECT_NE(plan.offsets[0], plan.offsets[1]);
  EXPECT_EQ(plan.total_bytes, 128U);
}

TEST(MemoryPlan, FillsAGapBetweenTwoBuffers) {
  const std::vector<Lifetime> buffers{{256, 0, 1}, {256, 0, 9}, {128, 2, 9}};
  EXPECT_EQ(plan_memory(buffers).total_bytes, 512U);
}

TEST(MemoryPlan, OfNothingIsNothing) {
  EXPECT_EQ(plan_memory({}).total_bytes, 0U);
}

TEST(MemoryPlan, NeverOverlapsNorMisaligns) {
  std::vector<Lifetime> buffers;
  for (uint32_t i = 0; i < 200; ++i) {
    const int first = static_cast<int>(test::hashed(i, 1) % 100);
    buffers.push_back(
        {test::hashed(i, 2) % 5000, first, first + static_cast<int>(test::hashed(i, 3) % 10)});
  }
  const MemoryPlan plan = plan_memory(buffers);
  size_t sum = 0;
  for (size_t a = 0; a < buffers.size(); ++a) {
    EXPECT_EQ(plan.offsets[a] % kBufferAlignment, 0U);
    EXPECT_LE(plan.offsets[a] + buffers[a].bytes, plan.total_bytes);
    sum += buffers[a].bytes;
    for (size_t b = 0; b < a; ++b) {
      const bool meet = buffers[a].first <= buffers[b].last && buffers[b].first <= buffers[a].last;
      const bool overlap = plan.offsets[a] < plan.offsets[b] + buffers[b].bytes &&
                           plan.offsets[b] < plan.offsets[a] + buffers[a].bytes;
      EXPECT_FALSE(meet && overlap) << a << " and " << b;
    }
  }
  EXPECT_LT(plan.total_bytes, sum / 4);
}

}  // namespace
}  // namespace bevloc::nn
