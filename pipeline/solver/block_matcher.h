// Every hypothesis at once, from correlations of blocks.
#pragma once

#include <vector>

#include "pipeline/solver/joint_volume.h"
#include "pipeline/solver/matcher.h"

namespace bevloc {

/// The joint volume (joint_volume.h) read out as training reads it: posterior =
/// softmax(joint_scale * volume), its marginals and its mean.
class BlockMatcher final : public Matcher {
 public:
  BlockMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
               const SolverParameters& parameters);

  void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) override;

 private:
  static constexpr double kBlock_m = 3.0;

  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  JointVolume joint_volume_;
  std::vector<float> bev_planes_;
  std::vector<float> map_planes_;
  std::vector<float> volume_;  ///< [yaw, x, y]
  std::vector<double> scores_;
};

}  // namespace bevloc
