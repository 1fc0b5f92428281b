// No solver may allocate after its first solution. This program counts all allocations.
#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

TEST(AllocationTest, NoneAfterTheFirstSolution) {
  constexpr int kChannels = 16;
  const SyntheticScene scene = SyntheticScene::structured(kChannels, 1);
  const auto bev = scene.seen_from({0.4, 0.2, 0.01}, kFeatureGrid);
  const auto map = scene.seen_from({}, kFeatureGrid);
  const std::vector<float> nothing(bev.size(), 0.0F);
  for (const SolverKind kind : all_solver_kinds()) {
    auto solver = make_solver(kind, kFeatureGrid, kChannels, HypothesisGrid{}, {}).value();
    SolverResult result;
    solver->solve(view(bev, kChannels, kFeatureGrid), view(map, kChannels, kFeatureGrid), result);
    const uint64_t before = bench::allocation_count();
    EXPECT_GT(before, 0U);
    solver->solve(view(map, kChannels, kFeatureGrid), view(bev, kChannels, kFeatureGrid), result);
    solver->solve(view(nothing, kChannels, kFeatureGrid), view(bev, kChannels, kFeatureGrid),
                  result);
    EXPECT_EQ(bench::allocation_count(), before) << name_of(kind);
  }
}

}  // namespace
}  // namespace bevloc
