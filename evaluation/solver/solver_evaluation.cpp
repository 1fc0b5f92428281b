#include "evaluation/solver/solver_evaluation.h"

#include <cassert>
#include <memory>

#include "common/heap_use.h"
#include "common/kernel_time.h"
#include "evaluation/solver/mask_input.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

/// Processor time of this thread. Other programs do not affect it.
double processor_time_ms() {
  return to_milliseconds(read_clock(CLOCK_THREAD_CPUTIME_ID));
}

/// A solver with its input and its latest result.
struct Candidate {
  std::unique_ptr<Solver> solver;
  const MaskInput* input;
  SolverResult result;
};

class Evaluation {
 public:
  Status prepare(const std::vector<SolverCase>& cases,
                 const std::vector<SolverParameters>& parameters);
  void run(const EvaluationOptions& options, const std::function<void(int)>& progress);
  std::vector<CaseResult> take_results() { return std::move(results_); }

 private:
  void solve(const sim::MatchingScene& scene, Candidate& candidate, CaseResult& result);

  MaskInputs inputs_;
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
  for (size_t i = 0; i < cases.size(); ++i) candidates_[i].input = inputs_.of(cases[i]);
  return {};
}

void Evaluation::run(const EvaluationOptions& options, const std::function<void(int)>& progress) {
  sim::SceneSampler sampler(options.seed_base);
  sim::MatchingScene scene;
  for (int i = 0; i < options.scenes; ++i) {
    sampler.make(static_cast<uint64_t>(i), options.corruption, scene);
    inputs_.take(scene.perceived, scene.raster_prior);
    for (size_t k = 0; k < candidates_.size(); ++k) solve(scene, candidates_[k], results_[k]);
    progress(i + 1);
  }
}

void Evaluation::solve(const sim::MatchingScene& scene, Candidate& candidate, CaseResult& result) {
  const FeatureView bev = candidate.input->bev();
  const FeatureView map = candidate.input->map();
  candidate.solver->solve(bev, map, candidate.result);
  // Only the second run is timed, so that the caches are warm for every solver.
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
