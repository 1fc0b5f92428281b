// Which pose solvers there are, by name.
#pragma once

#include <algorithm>
#include <memory>
#include <string_view>

#include "common/result.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

enum class SolverKind {
  kFull,            ///< "full": every hypothesis, the reference
  kDecoupled,       ///< "decoupled": the paper's, with the refinement pass; the default
  kDecoupledPlain,  ///< "decoupled-plain": the paper's alone
  kBlock,           ///< "block": every hypothesis, by block correlation
};

/// Fails with the names that are known.
Result<SolverKind> solver_kind_from(std::string_view name);
std::string_view name_of(SolverKind kind);

/// Largest ranges of the hypotheses: the solvers linearise and pad for small corrections, and
/// something must be left inside the border that the largest shift can move out of sight.
inline constexpr double kMaxYawRange_deg = 20.0;
constexpr double max_shift_m(const BevGrid& grid) {
  return 0.25 * std::min(grid.rows, grid.cols) * grid.cell_m;
}

/// Fails where the solver cannot work: a grid it cannot transform, hypotheses or parameters that
/// are not finite and positive, hypotheses beyond the largest ranges, a GeM exponent other than 1.
Result<std::unique_ptr<Solver>> make_solver(SolverKind kind, const BevGrid& grid, int channels,
                                            const HypothesisGrid& hypotheses,
                                            const SolverParameters& parameters);

}  // namespace bevloc
