// Time of each pose solver on the product's grid: 100 x 50 cells, 16 channels.
#include <benchmark/benchmark.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

void solve(benchmark::State& state, SolverKind kind) {
  constexpr int kChannels = 16;
  auto solver = make_solver(kind, kFeatureGrid, kChannels, {}, {}).value();
  const SyntheticScene scene = SyntheticScene::structured(kChannels, 1);
  const auto bev = scene.seen_from({0.7, -0.3, radians(0.6)}, kFeatureGrid);
  const auto map = scene.seen_from({}, kFeatureGrid);
  SolverResult result;
  for (auto _ : state) {
    solver->solve(view(bev, kChannels, kFeatureGrid), view(map, kChannels, kFeatureGrid), result);
    benchmark::DoNotOptimize(result.correction);
  }
}

const bool kRegistered = [] {
  for (const SolverKind kind : all_solver_kinds()) {
    benchmark::RegisterBenchmark(std::string(name_of(kind)).c_str(), solve, kind)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace bevloc
