#include "firmware/evaluation/scale_tuning.h"

#include <algorithm>
#include <array>
#include <functional>

#include <fmt/format.h>

namespace bevloc::evaluation {
namespace {

constexpr float kFirstScale = 6.0F;
constexpr float kScaleRatio = 1.35F;
constexpr size_t kScales = 14;

std::vector<float> candidate_scales() {
  std::vector<float> scales;
  for (float scale = kFirstScale; scales.size() < kScales; scale *= kScaleRatio) {
    scales.push_back(scale);
  }
  return scales;
}

SolverParameters with_all_scales(const SolverCase& solver_case, float scale) {
  SolverParameters parameters = hand_made_parameters(solver_case);
  parameters.joint_scale = scale;
  if (is_refined(solver_case.solver)) return parameters;
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
  tuned.joint_scale = best([](const PerAxis& n) { return n[0] + n[1] + n[2]; });
  if (is_refined(solver_case.solver)) return tuned;
  tuned.x_scale = tuned.banded_x_scale = best([](const PerAxis& n) { return n[0]; });
  tuned.y_scale = tuned.banded_y_scale = best([](const PerAxis& n) { return n[1]; });
  tuned.yaw_scale = best([](const PerAxis& n) { return n[2]; });
  return tuned;
}

std::string describe(const SolverParameters& parameters) {
  return fmt::format("joint {:.0f}, x {:.0f}, y {:.0f}, yaw {:.1f}, banded {:.0f} {:.0f}",
                     parameters.joint_scale, parameters.x_scale, parameters.y_scale,
                     parameters.yaw_scale, parameters.banded_x_scale, parameters.banded_y_scale);
}

}  // namespace bevloc::evaluation
