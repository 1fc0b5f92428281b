#include "evaluation/solver/distribution_figure.h"

#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "evaluation/solver/figure_json.h"
#include "evaluation/solver/hand_made_features.h"
#include "evaluation/solver/solver_case.h"

namespace bevloc::evaluation {
namespace {

constexpr std::array kShownSolvers{SolverKind::kFullFft, SolverKind::kDecoupled,
                                   SolverKind::kDecoupledRefined};

/// One axis of a solution. `unit` converts it to the unit that is shown.
struct Axis {
  const char* name;
  double unit;
  HypothesisAxis HypothesisGrid::*hypotheses;
  double Se2::*value;
  std::vector<float> SolverResult::*probability;
};
const std::array<Axis, 3> kAxes{
    {{"x_m", 1.0, &HypothesisGrid::x_m, &Se2::x_m, &SolverResult::x_probability},
     {"y_m", 1.0, &HypothesisGrid::y_m, &Se2::y_m, &SolverResult::y_probability},
     {"yaw_deg", degrees(1.0), &HypothesisGrid::yaw_rad, &Se2::yaw_rad,
      &SolverResult::yaw_probability}}};

Result<SolverResult> solve(const SolverCase& c, const sim::MatchingScene& scene) {
  const auto solver =
      make_solver(c.solver, c.grid, c.channels, c.hypotheses(), hand_made_parameters(c));
  if (!solver) return tl::unexpected(solver.error());
  const auto bev = features_of(scene.perceived, c.channels);
  const auto map = features_of(scene.raster_prior, c.channels);
  SolverResult result;
  (*solver)->solve({bev, c.channels, c.grid}, {map, c.channels, c.grid}, result);
  return result;
}

/// The truth and the hypotheses of each axis, without solutions yet.
nlohmann::json empty_axes(const Se2& truth) {
  const HypothesisGrid hypotheses = SolverCase{}.hypotheses();
  nlohmann::json axes;
  for (const Axis& axis : kAxes) {
    nlohmann::json& json = axes[axis.name];
    json["truth"] = axis.unit * truth.*axis.value;
    const HypothesisAxis& values = hypotheses.*axis.hypotheses;
    for (int i = 0; i < values.count(); ++i) {
      json["hypotheses"].push_back(axis.unit * values.value(i));
    }
  }
  return axes;
}

void add_solution(const SolverResult& result, nlohmann::json& axes) {
  for (size_t i = 0; i < kAxes.size(); ++i) {
    const Axis& axis = kAxes[i];
    const auto index = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(result.covariance(index, index));
    axes[axis.name]["solutions"].push_back({{"probability", result.*axis.probability},
                                            {"mean", axis.unit * result.correction.*axis.value},
                                            {"sigma", axis.unit * sigma}});
  }
}

}  // namespace

Result<nlohmann::json> distribution_figure(std::span<const sim::MatchingScene> scenes) {
  nlohmann::json json;
  for (const SolverKind kind : kShownSolvers) json["solvers"].push_back(name_of(kind));
  for (const sim::MatchingScene& scene : scenes) {
    nlohmann::json axes = empty_axes(scene.correction);
    for (const SolverKind kind : kShownSolvers) {
      const auto result = solve({.solver = kind}, scene);
      if (!result) return tl::unexpected(result.error());
      add_solution(*result, axes);
    }
    json["scenes"].push_back({{"road", sim::name(scene.kind)},
                              {"perceived", bytes_json(scene.perceived)},
                              {"raster_prior", bytes_json(scene.raster_prior)},
                              {"axes", std::move(axes)}});
  }
  return json;
}

}  // namespace bevloc::evaluation
