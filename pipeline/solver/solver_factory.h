// Which pose solvers there are, by name.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "common/result.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

enum class SolverKind {
  kFull,              ///< "full": every hypothesis by warping, the reference
  kFullFft,           ///< "full-fft": every hypothesis by cross-correlation
  kDecoupledLiteral,  ///< "decoupled-literal": the paper's, word for word
  kDecoupledLiteralRefined,
  kDecoupled,         ///< "decoupled": the paper's, as measurement mended it
  kDecoupledRefined,  ///< "decoupled+refine": followed by a refinement
  kBanded,            ///< "banded": axis matching band by band
  kBandedRefined,     ///< "banded+refine": the default
  kBlock,             ///< "block": every hypothesis, by block correlation
  kBlockRefined,
};

inline constexpr int kSolverKinds = 10;

/// Fails with the names that are known.
Result<SolverKind> solver_kind_from(std::string_view name);
std::string_view name_of(SolverKind kind);

/// All of them, the references first.
std::array<SolverKind, kSolverKinds> all_solver_kinds();

/// Whether it reads the features as they come, and GeM with any exponent (literal_matcher.h).
bool is_literal(SolverKind kind);

/// Whether a refinement follows (refinement.h).
bool is_refined(SolverKind kind);

/// Largest ranges of the hypotheses: the solvers linearise and pad for small corrections, and
/// something must be left inside the border that the largest shift can move out of sight.
inline constexpr double kMaxYawRange_deg = 20.0;
constexpr double max_shift_m(const BevGrid& grid) {
  return 0.25 * std::min(grid.rows, grid.cols) * grid.cell_m;
}

/// Fails where the solver cannot work: a grid it cannot transform, hypotheses or parameters that
/// are not finite and positive, hypotheses beyond the largest ranges, more features or hypotheses
/// than anyone needs, a GeM exponent other than 1 for any but the literal solvers.
Result<std::unique_ptr<Solver>> make_solver(SolverKind kind, const BevGrid& grid, int channels,
                                            const HypothesisGrid& hypotheses,
                                            const SolverParameters& parameters);

}  // namespace bevloc
