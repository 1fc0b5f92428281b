// Scores every hypothesis by correlating blocks of cells.
#pragma once

#include <vector>

#include "pipeline/solver/hypotheses.h"
#include "pipeline/solver/matcher.h"
#include "pipeline/solver/reference/joint_volume.h"
#include "pipeline/solver/solver_parameters.h"

namespace bevloc {

/// Uses the score that training uses (JointVolume): P = softmax(joint_scale * volume). The
/// distributions are the marginals of P, and the correction is its mean.
class BlockMatcher final : public Matcher {
 public:
  BlockMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
               const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  static constexpr double kBlock_m = 3.0;  ///< side of a block

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  JointVolume joint_volume_;
  std::vector<float> bev_planes_;
  std::vector<float> map_planes_;
  std::vector<float> volume_;  ///< [yaw, x, y]
  std::vector<double> scores_;
};

}  // namespace bevloc
