#include "training/native/moved_sums_op.h"

#include <vector>

#include "pipeline/solver/pose_scorer.h"
#include "training/native/moved_sums.h"

namespace {

using bevloc::CellFeatures;
using bevloc::MatchSums;
using bevloc::Se2;

constexpr int kSumCount = 3;

/// The features of both sides. Those of the vehicle have a margin for the largest correction.
struct Sides {
  explicit Sides(int channels)
      : bev(bevloc::kFeatureGrid, channels, bevloc::HypothesisGrid{}),
        map(bevloc::kFeatureGrid, channels) {}

  CellFeatures bev;
  CellFeatures map;
};

size_t feature_count(int channels) {
  return static_cast<size_t>(channels) * bevloc::kFeatureGrid.cells();
}

Se2 correction_of(const double* numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

void bevloc_moved_sums(int count, int channels, int poses, int step, int skew, const float* bev,
                       const float* map, const double* corrections, double* sums) {
  const size_t features = feature_count(channels);
  Sides sides(channels);
  const bevloc::LatticeCells cells(sides.map, {step, skew});
  for (int i = 0; i < count; ++i) {
    sides.bev.assign({bev + i * features, features});
    sides.map.assign({map + i * features, features});
    for (int j = 0; j < poses; ++j, corrections += 3, sums += kSumCount) {
      const MatchSums found = match_moved(sides.bev, sides.map, correction_of(corrections), cells);
      sums[0] = found.product;
      sums[1] = found.value;
      sums[2] = found.square;
    }
  }
}

void bevloc_moved_sums_gradients(int count, int channels, int poses, int step, int skew,
                                 const float* bev, const float* map, const double* corrections,
                                 const double* grad_sums, float* grad_bev, float* grad_map) {
  const size_t features = feature_count(channels);
  Sides sides(channels);
  std::vector<bevloc::MovedSlope> slopes(poses);
  for (int i = 0; i < count; ++i) {
    sides.bev.assign({bev + i * features, features});
    sides.map.assign({map + i * features, features});
    for (auto& [correction, slope] : slopes) {
      correction = correction_of(corrections);
      slope = {grad_sums[0], grad_sums[1], grad_sums[2]};
      corrections += 3;
      grad_sums += kSumCount;
    }
    Sides gradients(channels);  // zeros
    add_moved_gradients(sides.bev, sides.map, slopes, {step, skew}, gradients.bev, gradients.map);
    gradients.bev.copy_to({grad_bev + i * features, features});
    gradients.map.copy_to({grad_map + i * features, features});
  }
}
