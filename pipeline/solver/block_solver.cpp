#include "pipeline/solver/block_solver.h"

#include <algorithm>

#include "pipeline/solver/joint_posterior.h"
#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"

namespace bevloc {

BlockSolver::BlockSolver(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                         const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      joint_volume_(hypotheses, grid, channels),
      bev_(joint_volume_.feature_count()),
      map_(joint_volume_.feature_count()),
      volume_(joint_volume_.hypothesis_count()),
      scores_(joint_volume_.hypothesis_count()) {}

void BlockSolver::solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) {
  if (!standardise(bev, bev_) || !standardise(map, map_)) {
    return set_no_evidence(hypotheses_, result);
  }
  joint_volume_.scores(bev_, map_, volume_);
  std::ranges::copy(volume_, scores_.begin());
  softmax(scores_, parameters_.joint_scale, volume_);
  resize_distributions(hypotheses_, result);
  summarise_joint(volume_, hypotheses_, result);
}

}  // namespace bevloc
