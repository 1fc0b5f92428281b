// Time and memory of every pose solver at the paper's sizes, with ratios to full-fft: the medians
// of interleaved repeats, as one table. Options are Google Benchmark's.
#include <algorithm>
#include <map>
#include <random>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "common/heap_use.h"
#include "pipeline/solver/solver_factory.h"

namespace bevloc {
namespace {

struct Size {
  BevGrid grid;
  int channels;

  std::string name() const { return fmt::format("{}x{}x{}", grid.rows, grid.cols, channels); }
};

constexpr Size kSizes[] = {{kFeatureGrid, 16}, {kFeatureGrid, 64}, {kRasterGrid, 16}};

std::vector<float> random_features(const Size& size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> features(static_cast<size_t>(size.channels) * size.grid.cells());
  for (float& feature : features) feature = normal(random);
  return features;
}

void solve(benchmark::State& state, SolverKind kind, const Size& size) {
  const size_t before = heap_in_use_bytes();
  auto solver = make_solver(kind, size.grid, size.channels, {}, {}).value();
  state.counters["buffers"] = static_cast<double>(heap_in_use_bytes() - before);
  const auto bev = random_features(size, 1);
  const auto map = random_features(size, 2);
  SolverResult result;
  for (auto _ : state) {
    solver->solve({bev, size.channels, size.grid}, {map, size.channels, size.grid}, result);
    benchmark::DoNotOptimize(result.correction);
  }
}

/// Prints one line for each solver and size, once all have run.
class TableReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& /*context*/) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Aggregate || run.aggregate_name != "median") continue;
      rows_[run.run_name.function_name] = {run.GetAdjustedCPUTime(), run.counters.at("buffers")};
    }
  }

  void Finalize() override {
    fmt::print("{:40} {:>10} {:>12} {:>14}\n", "solver, size", "CPU ms", "of full-fft",
               "buffers, MiB");
    for (const Size& size : kSizes) {
      for (const SolverKind kind : all_solver_kinds()) print_row(kind, size);
    }
  }

  static std::string name(SolverKind kind, const Size& size) {
    return fmt::format("{:26} {}", name_of(kind), size.name());
  }

 private:
  struct Row {
    double time_ms = 0.0;
    double bytes = 0.0;
  };

  void print_row(SolverKind kind, const Size& size) const {
    const auto row = rows_.find(name(kind, size));
    if (row == rows_.end()) return;
    const auto reference = rows_.find(name(SolverKind::kFullFft, size));
    const std::string ratio =
        reference == rows_.end()
            ? "-"
            : fmt::format("1/{:.2f}", reference->second.time_ms / row->second.time_ms);
    fmt::print("{:40} {:10.3f} {:>12} {:14.2f}\n", row->first, row->second.time_ms, ratio,
               row->second.bytes / (1024.0 * 1024.0));
  }

  std::map<std::string, Row> rows_;
};

void register_all() {
  for (const Size& size : kSizes) {
    for (const SolverKind kind : all_solver_kinds()) {
      benchmark::RegisterBenchmark(TableReporter::name(kind, size).c_str(), solve, kind, size)
          ->Unit(benchmark::kMillisecond)
          ->Repetitions(5)
          ->MinTime(0.1);
    }
  }
}

}  // namespace
}  // namespace bevloc

int main(int argc, char** argv) {
  benchmark::SetDefaultTimeUnit(benchmark::kMillisecond);
  // The repeats are interleaved, so that a disturbance of the machine affects all solvers alike.
  std::string interleave = "--benchmark_enable_random_interleaving=true";
  std::vector<char*> arguments(argv, argv + argc);
  arguments.insert(arguments.begin() + 1, interleave.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  bevloc::register_all();
  bevloc::TableReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
