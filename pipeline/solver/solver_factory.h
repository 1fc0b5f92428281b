// Makes pose solvers by kind or name, and checks their arguments.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "common/result.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

enum class SolverKind {
  kFull,                     ///< "full": scores every hypothesis by warping; the reference
  kFullFft,                  ///< "full-fft": scores every hypothesis by cross-correlation
  kDecoupledLiteral,         ///< "decoupled-literal": the paper's method, read literally
  kDecoupledLiteralRefined,  ///< "decoupled-literal+refine"
  kDecoupled,                ///< "decoupled": the paper's method with this project's changes
  kDecoupledRefined,         ///< "decoupled+refine"
  kBanded,                   ///< "banded": axis matching band by band
  kBandedRefined,            ///< "banded+refine": the default
  kBlock,                    ///< "block": scores every hypothesis by correlating blocks
  kBlockRefined,             ///< "block+refine"
};

inline constexpr int kSolverKinds = 10;

/// The kind with this name. Fails with the list of known names.
Result<SolverKind> solver_kind_from(std::string_view name);
std::string_view name_of(SolverKind kind);

/// All kinds, in the order of the enumeration.
std::array<SolverKind, kSolverKinds> all_solver_kinds();

/// Whether the matcher reads features that are not standardised, and accepts any GeM exponent
/// (reference/literal_matcher.h).
bool is_literal(SolverKind kind);

/// Whether a refinement follows the matcher (refinement.h).
bool is_refined(SolverKind kind);

/// Largest hypotheses. The solvers linearise and pad for small corrections, and a part of the grid
/// must stay in view under every hypothesis.
inline constexpr double kMaxYawRange_deg = 20.0;
constexpr double max_shift_m(const BevGrid& grid) {
  return 0.25 * std::min(grid.rows, grid.cols) * grid.cell_m;
}
// Limits far beyond any use, so that a typing error is reported instead of exhausting the memory.
inline constexpr double kMaxHalfCount = 1000.0;  ///< steps from zero to the end of an axis
inline constexpr double kMaxHypotheses = 1e6;

/// Whether the solvers take the axis: 0 < step <= range, at most kMaxHalfCount steps, and
/// farthest() at most `max_range`.
bool is_sound(const HypothesisAxis& axis, double max_range);
/// The number of all hypotheses, which may be more than an int holds.
double count_of(const HypothesisGrid& hypotheses);

/// Makes a solver. Fails if
/// - the matcher cannot work on `grid`,
/// - hypotheses or parameters are not finite and positive,
/// - hypotheses exceed max_shift_m() or kMaxYawRange_deg,
/// - there are more features or hypotheses than any use needs, or
/// - gem_omega is not 1 and the solver is not literal.
Result<std::unique_ptr<Solver>> make_solver(SolverKind kind, const BevGrid& grid, int channels,
                                            const HypothesisGrid& hypotheses,
                                            const SolverParameters& parameters);

}  // namespace bevloc
