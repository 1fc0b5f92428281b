// Every hypothesis at once, from correlations of blocks.
#pragma once

#include <vector>

#include "pipeline/solver/joint_volume.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// The joint volume (joint_volume.h) read out as training reads it: posterior =
/// softmax(joint_scale * volume), its marginals, its mean and its covariance.
class BlockSolver final : public Solver {
 public:
  BlockSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
              const SolverParameters& parameters);

  void solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) override;

 private:
  HypothesisGrid hypotheses_;
  SolverParameters parameters_;
  JointVolume joint_volume_;
  std::vector<float> bev_;  ///< standardised, [channels, rows, cols]
  std::vector<float> map_;
  std::vector<float> volume_;  ///< [yaw, x, y]
  std::vector<double> scores_;
};

}  // namespace bevloc
