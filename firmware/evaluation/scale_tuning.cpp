#include "firmware/evaluation/scale_tuning.h"

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

SolverParameters with_all_scales(const SolverCase& solver_case, float scale) {
  SolverParameters parameters = hand_made_parameters(solver_case);
  if (is_refined(solver_case.solver)) {
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

Result<SolverParameters> tune_scales(const SolverCase& solver_case,
                                     const EvaluationOptions& options) {
  const std::vector<float> scales = candidate_scales();
  std::vector<SolverParameters> parameters;
  for (float scale : scales) parameters.push_back(with_all_scales(solver_case, scale));
  const auto results =
      evaluate_solvers(std::vector(scales.size(), solver_case), parameters, options, [](int) {});
  if (!results) return tl::unexpected(results.error());
  std::vector<PerAxis> nll;
  for (const CaseResult& result : *results) nll.push_back(summarise(result.outcomes).nll);
  const auto best = [&](const std::function<double(const PerAxis&)>& cost) {
    return scales[std::ranges::min_element(nll, {}, cost) - nll.begin()];
  };
  SolverParameters tuned = hand_made_parameters(solver_case);
  const float joint = best([](const PerAxis& n) { return n[0] + n[1] + n[2]; });
  const float x = best([](const PerAxis& n) { return n[0]; });
  const float y = best([](const PerAxis& n) { return n[1]; });
  const float yaw = best([](const PerAxis& n) { return n[2]; });
  if (is_refined(solver_case.solver)) {
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

std::string describe(const SolverParameters& parameters) {
  const SolverParameters& p = parameters;
  return fmt::format("joint {:.0f}, axes {:.0f} {:.0f} {:.0f}, refine {:.0f} {:.0f} {:.0f}",
                     p.joint_scale, p.x_scale, p.y_scale, p.yaw_scale, p.refine_x_scale,
                     p.refine_y_scale, p.refine_yaw_scale);
}

}  // namespace bevloc::evaluation
