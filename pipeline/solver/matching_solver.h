// The solver that all kinds share: standardise, match, refine, and say how far to trust it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pipeline/solver/match_covariance.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/refinement.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

enum class Refine { kNo, kYes };

/// The covariance joins two deviations per axis, that of the distribution (which knows of rivals
/// and of the score's shape) and that of MatchCovariance (which knows how much there is to see), as
/// a weighted geometric mean, with MatchCovariance's correlations.
class MatchingSolver final : public Solver {
 public:
  MatchingSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                 const SolverParameters& parameters, std::unique_ptr<Matcher> matcher,
                 Refine refine);

  void solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) override;

 private:
  Eigen::Matrix3d covariance(const SolverResult& result);
  Eigen::Vector3d claimed_deviations(const SolverResult& result) const;

  HypothesisGrid hypotheses_;
  double sigma_scale_;
  CellFeatures bev_cells_;
  CellFeatures map_cells_;
  std::unique_ptr<Matcher> matcher_;
  std::optional<Refinement> refinement_;
  MatchCovariance match_covariance_;
};

}  // namespace bevloc
