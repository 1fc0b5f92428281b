#include "pipeline/solver/solver_factory.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "pipeline/solver/block_solver.h"
#include "pipeline/solver/decoupled_solver.h"
#include "pipeline/solver/full_solver.h"

namespace bevloc {
namespace {

constexpr std::array<std::pair<std::string_view, SolverKind>, 4> kNames{{
    {"full", SolverKind::kFull},
    {"decoupled", SolverKind::kDecoupled},
    {"decoupled-plain", SolverKind::kDecoupledPlain},
    {"block", SolverKind::kBlock},
}};

bool is_positive(double value) {
  return std::isfinite(value) && value > 0.0;
}

Status check_axis(std::string_view name, const HypothesisAxis& axis, double max_range) {
  if (!is_positive(axis.step) || !is_positive(axis.range) || axis.step > axis.range ||
      axis.range > max_range) {
    return fail("hypotheses of {}: range {} and step {}, wanted 0 < step <= range <= {}", name,
                axis.range, axis.step, max_range);
  }
  return {};
}

Status check_parameters(const SolverParameters& parameters) {
  for (const auto& [name, scale] :
       {std::pair("joint_scale", parameters.joint_scale), std::pair("x_scale", parameters.x_scale),
        std::pair("y_scale", parameters.y_scale), std::pair("yaw_scale", parameters.yaw_scale)}) {
    if (!is_positive(scale)) {
      return fail("solver parameter {} is {}, wanted a finite number above 0", name, scale);
    }
  }
  if (parameters.gem_omega != 1.0F) {
    return fail("solver parameter gem_omega is {}, wanted 1 (the plain mean)",
                parameters.gem_omega);
  }
  return {};
}

Status check(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses) {
  if (channels <= 0) return fail("solver: {} channels, wanted at least 1", channels);
  if (grid.cells() <= 0 || !is_positive(grid.cell_m) || !YawSpectrum::covers(grid)) {
    return fail(
        "solver: grid of {} x {} cells of {} m, wanted 1 to {} rows and columns of cells up to "
        "{:.2f} m",
        grid.rows, grid.cols, grid.cell_m, kFftSize,
        (AmplitudeSpectrum::kCols - 1) / (YawSpectrum::kMaxFrequency * kFftSize));
  }
  const double max_range_m = max_shift_m(grid);
  if (auto status = check_axis("x", hypotheses.x_m, max_range_m); !status) return status;
  if (auto status = check_axis("y", hypotheses.y_m, max_range_m); !status) return status;
  return check_axis("yaw", hypotheses.yaw_rad, radians(kMaxYawRange_deg));
}

}  // namespace

Result<SolverKind> solver_kind_from(std::string_view name) {
  std::string known;
  for (const auto& [candidate, kind] : kNames) {
    if (candidate == name) return kind;
    known += known.empty() ? "" : ", ";
    known += candidate;
  }
  return fail("solver: found \"{}\", wanted one of {}", name, known);
}

std::string_view name_of(SolverKind kind) {
  const auto found =
      std::ranges::find(kNames, kind, &std::pair<std::string_view, SolverKind>::second);
  assert(found != kNames.end());
  return found->first;
}

Result<std::unique_ptr<Solver>> make_solver(SolverKind kind, const BevGrid& grid, int channels,
                                            const HypothesisGrid& hypotheses,
                                            const SolverParameters& parameters) {
  if (auto status = check(grid, channels, hypotheses); !status) {
    return tl::unexpected(status.error());
  }
  if (auto status = check_parameters(parameters); !status) return tl::unexpected(status.error());
  switch (kind) {
    case SolverKind::kFull:
      return std::make_unique<FullSolver>(grid, channels, hypotheses, parameters);
    case SolverKind::kDecoupled:
      return std::make_unique<DecoupledSolver>(grid, channels, hypotheses, parameters,
                                               Refinement::kOn);
    case SolverKind::kDecoupledPlain:
      return std::make_unique<DecoupledSolver>(grid, channels, hypotheses, parameters,
                                               Refinement::kOff);
    case SolverKind::kBlock:
      return std::make_unique<BlockSolver>(grid, channels, hypotheses, parameters);
  }
  return fail("solver: kind {} is not known", static_cast<int>(kind));
}

}  // namespace bevloc
