// The pose solver: finds the correction that aligns the BEV features with the map features.
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Core>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/feature_view.h"
#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/match_covariance.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/refinement.h"
#include "pipeline/solver/solver_parameters.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc {

/// Whether a refinement follows the matcher.
enum class Refine { kNo, kYes };

/// Standardises the features, calls the matcher, refines its result if asked, and computes the
/// covariance. Make one with make_solver() (solver_factory.h), which checks the arguments.
///
/// The covariance combines two standard deviations per axis. That of the distribution knows about
/// rival peaks and the shape of the score; that of MatchCovariance knows how much structure the
/// scene has. Their weighted geometric mean is scaled, and the correlations are MatchCovariance's
/// (docs/solver.md).
///
/// The constructor allocates all scratch memory. solve() allocates nothing if an earlier call has
/// already filled `result`. One thread.
class Solver {
 public:
  Solver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
         const SolverParameters& parameters, std::unique_ptr<Matcher> matcher, Refine refine);

  /// Finds the correction under which `bev` (vehicle frame) aligns with `map` (drawn at T0). Both
  /// must be on the solver's grid. If there is nothing to match, or the number of values is not
  /// rows x columns x channels, `result.evidence` is kNone (set_no_evidence()). Every value of
  /// `result` is finite.
  void solve(const FeatureView& bev, const FeatureView& map, SolverResult& result);

  /// The standardised features of the latest solve() with evidence: those of the map, and the BEV
  /// features moved by its correction, [row, col, lanes].
  const CellFeatures& map_cells() const { return map_cells_; }
  const LaneBuffer& moved_cells() const { return match_covariance_.moved(); }

 private:
  Eigen::Matrix3d covariance(const SolverResult& result);
  Eigen::Vector3d distribution_sigmas(const SolverResult& result) const;

  HypothesisGrid hypotheses_;
  double sigma_scale_;
  double score_scale_;
  CellFeatures bev_cells_;
  CellFeatures map_cells_;
  std::unique_ptr<Matcher> matcher_;
  std::optional<Refinement> refinement_;
  MatchCovariance match_covariance_;
};

}  // namespace bevloc
