#include "pipeline/solver/pose_scorer.h"

#include <algorithm>

#include "common/target_clones.h"
#include "pipeline/solver/feature_warp.h"

namespace bevloc {
namespace {

/// `lanes_per_cell` is line.lanes, known to the compiler where it can be. Two cells at a time, to
/// hide the latency of the additions.
[[gnu::always_inline]] inline MatchSums match_cells(WarpLine line, int lanes_per_cell,
                                                    const float* map) {
  line.lanes = lanes_per_cell;
  LaneSums even;
  LaneSums odd;
  Lanes moved;
  TapGroups groups(line);
  for (int first = 0; first < line.cells; first += kLanes) {
    const Taps& taps = groups.next();
    const int count = std::min(kLanes, line.cells - first);
    int i = 0;
    for (; i + 1 < count; i += 2, map += 2 * lanes_per_cell) {
      for (int k = 0; k < lanes_per_cell; k += kLanes) {
        line.read(taps, i, k, moved);
        even.add(lanes(map + k), moved);
        line.read(taps, i + 1, k, moved);
        odd.add(lanes(map + lanes_per_cell + k), moved);
      }
    }
    for (; i < count; ++i, map += lanes_per_cell) {
      for (int k = 0; k < lanes_per_cell; k += kLanes) {
        line.read(taps, i, k, moved);
        even.add(lanes(map + k), moved);
      }
    }
  }
  return sum_of(even, odd);
}

BEVLOC_TARGET_CLONES MatchSums match_line(const WarpLine& line, const float* map) {
  return line.lanes == kLanes ? match_cells(line, kLanes, map) : match_cells(line, line.lanes, map);
}

}  // namespace

MatchSums match_moved(const CellFeatures& bev, const CellFeatures& map, const Se2& correction) {
  const BevGrid& grid = map.grid();
  const FeatureWarp moved(bev, correction);
  MatchSums sums;
  for (int row = 0; row < grid.rows; ++row) {
    sums += match_line(moved.line(row, 0, grid.cols), map.cell(row, 0));
  }
  return sums;
}

PoseScorer::PoseScorer(const CellFeatures& bev, const CellFeatures& map)
    : bev_(bev), map_(map), map_moments_(moments_of(map)) {}

double PoseScorer::score(const Se2& correction) const {
  const double count = static_cast<double>(map_.grid().cells()) * map_.channels();
  return zncc(match_moved(bev_, map_, correction), map_moments_, count);
}

}  // namespace bevloc
