#include "firmware/evaluation/solver_evaluation.h"

#include <algorithm>
#include <cassert>
#include <ctime>
#include <memory>
#include <span>

#include "common/heap_use.h"
#include "sim/perception/mask_features.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

/// Time that this thread has had of a processor: another program beside it does not count.
double processor_time_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// The features of one scene in one size, which several solvers share.
class SceneFeatures {
 public:
  SceneFeatures(int channels, const BevGrid& grid)
      : channels_(channels),
        grid_(grid),
        maker_(channels, grid),
        bev_(static_cast<size_t>(channels) * grid.cells()),
        map_(bev_.size()) {}

  bool serves(const SolverCase& solver_case) const {
    return solver_case.channels == channels_ && solver_case.grid.rows == grid_.rows;
  }
  void take(const sim::MatchingScene& scene) {
    maker_.compute(std::span<const float>(scene.perceived), bev_);
    maker_.compute(std::span<const uint8_t>(scene.raster_prior), map_);
  }
  FeatureView bev() const { return {bev_, channels_, grid_}; }
  FeatureView map() const { return {map_, channels_, grid_}; }

 private:
  int channels_;
  BevGrid grid_;
  sim::MaskFeatures maker_;
  std::vector<float> bev_;
  std::vector<float> map_;
};

/// A solver with the features it reads.
struct Candidate {
  std::unique_ptr<Solver> solver;
  const SceneFeatures* features;
  SolverResult result;
};

class Evaluation {
 public:
  Status prepare(const std::vector<SolverCase>& cases,
                 const std::vector<SolverParameters>& parameters);
  void run(const EvaluationOptions& options, const std::function<void(int)>& progress);
  std::vector<CaseResult> take_results() { return std::move(results_); }

 private:
  const SceneFeatures* features_for(const SolverCase& solver_case);
  void solve(const sim::MatchingScene& scene, Candidate& candidate, CaseResult& result);

  std::vector<std::unique_ptr<SceneFeatures>> features_;
  std::vector<Candidate> candidates_;
  std::vector<CaseResult> results_;
};

Status Evaluation::prepare(const std::vector<SolverCase>& cases,
                           const std::vector<SolverParameters>& parameters) {
  assert(cases.size() == parameters.size());
  for (size_t i = 0; i < cases.size(); ++i) {
    const size_t before = heap_in_use_bytes();
    auto solver = make_solver(cases[i].solver, cases[i].grid, cases[i].channels,
                              cases[i].hypotheses(), parameters[i]);
    if (!solver) return tl::unexpected(solver.error());
    results_.push_back({cases[i], {}, heap_in_use_bytes() - before});
    candidates_.push_back({std::move(*solver), nullptr, {}});
  }
  for (size_t i = 0; i < cases.size(); ++i) candidates_[i].features = features_for(cases[i]);
  return {};
}

const SceneFeatures* Evaluation::features_for(const SolverCase& solver_case) {
  const auto found = std::ranges::find_if(
      features_, [&](const auto& features) { return features->serves(solver_case); });
  if (found != features_.end()) return found->get();
  return features_
      .emplace_back(std::make_unique<SceneFeatures>(solver_case.channels, solver_case.grid))
      .get();
}

void Evaluation::run(const EvaluationOptions& options, const std::function<void(int)>& progress) {
  sim::SceneSampler sampler(options.seed_base);
  sim::MatchingScene scene;
  for (int i = 0; i < options.scenes; ++i) {
    sampler.make(static_cast<uint64_t>(i), options.corruption, scene);
    for (const auto& features : features_) features->take(scene);
    for (size_t k = 0; k < candidates_.size(); ++k) solve(scene, candidates_[k], results_[k]);
    progress(i + 1);
  }
}

void Evaluation::solve(const sim::MatchingScene& scene, Candidate& candidate, CaseResult& result) {
  const FeatureView bev = candidate.features->bev();
  const FeatureView map = candidate.features->map();
  candidate.solver->solve(bev, map, candidate.result);
  // Timed again: what the solver costs, not what the others left in the cache.
  const double start_ms = processor_time_ms();
  candidate.solver->solve(bev, map, candidate.result);
  const double end_ms = processor_time_ms();
  Outcome outcome = judge(candidate.result, result.solver_case.hypotheses(), scene.correction);
  outcome.road = scene.kind;
  outcome.time_ms = end_ms - start_ms;
  result.outcomes.push_back(outcome);
}

}  // namespace

Result<std::vector<CaseResult>> evaluate_solvers(const std::vector<SolverCase>& cases,
                                                 const std::vector<SolverParameters>& parameters,
                                                 const EvaluationOptions& options,
                                                 const std::function<void(int done)>& progress) {
  Evaluation evaluation;
  if (Status status = evaluation.prepare(cases, parameters); !status) {
    return tl::unexpected(status.error());
  }
  evaluation.run(options, progress);
  return evaluation.take_results();
}

}  // namespace bevloc::evaluation
