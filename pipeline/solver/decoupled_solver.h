// Decoupled neural matching: yaw, then x and y, each on features of its own.
#pragma once

#include <vector>

#include "pipeline/solver/axis_matching.h"
#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/match_covariance.h"
#include "pipeline/solver/solver.h"
#include "pipeline/solver/translation_scorer.h"
#include "pipeline/solver/yaw_spectrum.h"

namespace bevloc {

enum class Refinement { kOff, kOn };

/// The paper's solver (III-D, eq. 7 to 14): yaw from amplitude spectra, the features turned by it,
/// then x and y from axis features; 53 hypotheses in place of 4,851. Every estimate is the mean of
/// its distribution.
///
/// With refinement, one pass of the full solver's score follows along each axis in the order y,
/// yaw, x through the estimate so far, over the same hypotheses; its distributions replace the
/// first ones. The covariance is the larger, per axis, of the distribution's variance and of what
/// MatchCovariance can vouch for, with the latter's correlations.
class DecoupledSolver final : public Solver {
 public:
  DecoupledSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                  const SolverParameters& parameters, Refinement refinement);

  void solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) override;

 private:
  void solve_decoupled(SolverResult& result);
  void refine(SolverResult& result);
  Eigen::Matrix3d covariance(const SolverResult& result);

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  Refinement refinement_;
  CellFeatures bev_;
  CellFeatures map_;
  YawSpectrum yaw_spectrum_;
  AxisMatching axis_matching_;
  ShiftPlan x_plan_;
  ShiftPlan y_plan_;
  ShiftPlan x_fixed_;
  ShiftPlan y_fixed_;
  TranslationScorer scorer_;
  MatchCovariance match_covariance_;
  double cell_m_;
  std::vector<float> standardised_;
  std::vector<double> x_scores_;
  std::vector<double> y_scores_;
  std::vector<double> yaw_scores_;
};

}  // namespace bevloc
