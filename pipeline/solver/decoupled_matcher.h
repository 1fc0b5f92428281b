// Decoupled neural matching: yaw, then x and y, each on features of its own.
#pragma once

#include <vector>

#include "pipeline/solver/axis_matching.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/yaw_spectrum.h"

namespace bevloc {

/// The paper's solver (III-D, eq. 7 to 14) as this project builds it: yaw from one amplitude
/// spectrum per side, the features turned by it, then x and y from axis features; 53 hypotheses in
/// place of 4,851. Every estimate is the mean of its distribution.
class DecoupledMatcher final : public Matcher {
 public:
  DecoupledMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                   const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  YawSpectrum yaw_spectrum_;
  AxisMatching axis_matching_;
  std::vector<double> x_scores_;
  std::vector<double> y_scores_;
  std::vector<double> yaw_scores_;
};

}  // namespace bevloc
