#include "pipeline/solver/reference/block_matcher.h"

#include <algorithm>
#include <cmath>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/reference/joint_posterior.h"

namespace bevloc {

BlockMatcher::BlockMatcher(const BevGrid& grid, int channels, const HypothesisGrid& hypotheses,
                           const SolverParameters& parameters)
    : hypotheses_(hypotheses),
      parameters_(parameters),
      joint_volume_(hypotheses, grid, channels,
                    std::max(1, static_cast<int>(std::lround(kBlock_m / grid.cell_m)))),
      bev_planes_(static_cast<size_t>(channels) * grid.cells()),
      map_planes_(bev_planes_.size()),
      volume_(hypotheses.count()),
      scores_(hypotheses.count()) {}

void BlockMatcher::match(const MatchSide& bev, const MatchSide& map, SolverResult& result) {
  bev.cells.copy_to(bev_planes_);
  map.cells.copy_to(map_planes_);
  joint_volume_.scores(bev_planes_, map_planes_, volume_);
  std::ranges::copy(volume_, scores_.begin());
  softmax(scores_, parameters_.joint_scale, volume_);
  summarise_joint(volume_, hypotheses_, result);
}

}  // namespace bevloc
