#include "evaluation/solver/scale_tuning.h"

#include <algorithm>
#include <array>
#include <functional>

#include <fmt/format.h>

namespace bevloc::evaluation {
namespace {

constexpr float kFirstScale = 12.0F;
constexpr float kScaleRatio = 1.4F;
constexpr size_t kScales = 13;

std::vector<float> candidate_scales() {
  std::vector<float> scales;
  for (float scale = kFirstScale; scales.size() < kScales; scale *= kScaleRatio) {
    scales.push_back(scale);
  }
  return scales;
}

/// `start`, in which every scale that a solver of this kind uses is replaced. A refined solver
/// keeps the scales of the solver that it refines.
SolverParameters with_all_scales(SolverKind kind, const SolverParameters& start, float scale) {
  SolverParameters parameters = start;
  if (is_refined(kind)) {
    parameters.refine_x_scale = scale;
    parameters.refine_y_scale = scale;
    parameters.refine_yaw_scale = scale;
    return parameters;
  }
  parameters.joint_scale = scale;
  parameters.x_scale = scale;
  parameters.y_scale = scale;
  parameters.yaw_scale = scale;
  parameters.banded_x_scale = scale;
  parameters.banded_y_scale = scale;
  return parameters;
}

}  // namespace

Result<SolverParameters> best_scales(SolverKind kind, const SolverParameters& start,
                                     const ScaleTrial& trial) {
  const std::vector<float> scales = candidate_scales();
  std::vector<SolverParameters> candidates;
  for (float scale : scales) candidates.push_back(with_all_scales(kind, start, scale));
  const auto nll = trial(candidates);
  if (!nll) return tl::unexpected(nll.error());
  const auto best = [&](const std::function<double(const PerAxis&)>& cost) {
    return scales[std::ranges::min_element(*nll, {}, cost) - nll->begin()];
  };
  SolverParameters tuned = start;
  const float joint = best([](const PerAxis& n) { return n[0] + n[1] + n[2]; });
  const float x = best([](const PerAxis& n) { return n[0]; });
  const float y = best([](const PerAxis& n) { return n[1]; });
  const float yaw = best([](const PerAxis& n) { return n[2]; });
  if (is_refined(kind)) {
    tuned.refine_x_scale = x;
    tuned.refine_y_scale = y;
    tuned.refine_yaw_scale = yaw;
    return tuned;
  }
  tuned.joint_scale = joint;
  tuned.x_scale = tuned.banded_x_scale = x;
  tuned.y_scale = tuned.banded_y_scale = y;
  tuned.yaw_scale = yaw;
  return tuned;
}

Result<SolverParameters> tune_scales(const SolverCase& solver_case,
                                     const EvaluationOptions& options) {
  const auto trial =
      [&](const std::vector<SolverParameters>& candidates) -> Result<std::vector<PerAxis>> {
    const auto results = evaluate_solvers(std::vector(candidates.size(), solver_case), candidates,
                                          options, [](int) {});
    if (!results) return tl::unexpected(results.error());
    std::vector<PerAxis> nll;
    for (const CaseResult& result : *results) nll.push_back(summarise(result.outcomes).nll);
    return nll;
  };
  return best_scales(solver_case.solver, hand_made_parameters(solver_case), trial);
}

std::string describe(const SolverParameters& parameters) {
  const SolverParameters& p = parameters;
  return fmt::format("joint {:.0f}, axes {:.0f} {:.0f} {:.0f}, refine {:.0f} {:.0f} {:.0f}",
                     p.joint_scale, p.x_scale, p.y_scale, p.yaw_scale, p.refine_x_scale,
                     p.refine_y_scale, p.refine_yaw_scale);
}

}  // namespace bevloc::evaluation
