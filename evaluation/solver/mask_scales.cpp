#include "evaluation/solver/mask_scales.h"

#include <algorithm>
#include <memory>

#include "evaluation/solver/scale_tuning.h"

namespace bevloc::evaluation {
namespace {

/// The solver without refinement that a refined solver begins with.
SolverKind coarse_of(SolverKind kind) {
  return kind == SolverKind::kBandedRefined ? SolverKind::kBanded : SolverKind::kDecoupled;
}

}  // namespace

Result<SolverParameters> MaskScales::parameters_for(SolverCase solver_case) {
  solver_case.step_m = SolverCase{}.step_m;
  const auto known =
      std::ranges::find(found_, solver_case, &std::pair<SolverCase, SolverParameters>::first);
  if (known != found_.end()) return known->second;
  auto tuned = tune(solver_case);
  if (tuned) found_.emplace_back(solver_case, *tuned);
  return tuned;
}

Result<SolverParameters> MaskScales::tune(const SolverCase& solver_case) {
  SolverParameters start = hand_made_parameters(solver_case);
  if (is_refined(solver_case.solver)) {
    SolverCase coarse = solver_case;
    coarse.solver = coarse_of(solver_case.solver);
    const auto of_coarse = parameters_for(coarse);
    if (!of_coarse) return of_coarse;
    start = *of_coarse;
  }
  return best_scales(solver_case.solver, start,
                     [&](const auto& candidates) { return likelihoods(solver_case, candidates); });
}

Result<std::vector<PerAxis>> MaskScales::likelihoods(
    const SolverCase& solver_case, const std::vector<SolverParameters>& candidates) const {
  const HypothesisGrid hypotheses = solver_case.hypotheses();
  std::vector<std::unique_ptr<Solver>> solvers;
  for (const SolverParameters& parameters : candidates) {
    auto solver = make_solver(solver_case.solver, solver_case.grid, solver_case.channels,
                              hypotheses, parameters);
    if (!solver) return tl::unexpected(solver.error());
    solvers.push_back(std::move(*solver));
  }
  MaskInput input(solver_case.channels, solver_case.grid);
  SolverResult solution;
  std::vector<std::vector<Outcome>> outcomes(solvers.size());
  for (const TuningSample& sample : samples_) {
    input.take(sample.*mask_, sample.raster);
    for (size_t i = 0; i < solvers.size(); ++i) {
      solvers[i]->solve(input.bev(), input.map(), solution);
      outcomes[i].push_back(judge(solution, hypotheses, sample.correction));
    }
  }
  std::vector<PerAxis> nll(outcomes.size());
  std::ranges::transform(outcomes, nll.begin(),
                         [](const auto& of_solver) { return summarise(of_solver).nll; });
  return nll;
}

}  // namespace bevloc::evaluation
