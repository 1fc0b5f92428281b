#include "pipeline/solver/standardise.h"

#include <algorithm>
#include <cmath>

#include "common/target_clones.h"

namespace bevloc {
namespace {

constexpr double kCellStdEpsilon = 0.01;
/// A channel with a smaller standard deviation counts as constant, because it varies by rounding
/// alone.
constexpr double kLeastStd = 1e-4;

/// Moments of kLanes neighbouring channels.
struct Moments {
  LaneDoubles mean;
  LaneDoubles std;
};

/// Sums the differences from the first cell in one pass, so that a constant channel gets a standard
/// deviation of exactly 0. It sums quarters, because differences of large floats may overflow.
BEVLOC_TARGET_CLONES void find_moments(const CellFeatures& features, int first_lane,
                                       Moments& moments) {
  constexpr float kQuarter = 0.25F;
  const BevGrid& grid = features.grid();
  const Lanes origin = kQuarter * lanes(features.cell(0, 0) + first_lane);
  // Two cells at a time, to hide the latency of the additions.
  LaneDoubles sums[2] = {};
  LaneDoubles squares[2] = {};
  for (int row = 0; row < grid.rows; ++row) {
    const float* cell = features.cell(row, 0) + first_lane;
    for (int col = 0; col < grid.cols; ++col, cell += features.lanes()) {
      const Lanes distance = kQuarter * lanes(cell) - origin;
      const auto exact = __builtin_convertvector(distance, LaneDoubles);
      sums[col % 2] += exact;
      squares[col % 2] += exact * exact;
    }
  }
  const LaneDoubles sum = sums[0] + sums[1];
  const LaneDoubles square = squares[0] + squares[1];
  const LaneDoubles mean = sum / grid.cells();
  const LaneDoubles variance = square / grid.cells() - mean * mean;
  moments.mean = (__builtin_convertvector(origin, LaneDoubles) + mean) / kQuarter;
  for (int k = 0; k < kLanes; ++k) {
    moments.std[k] = std::sqrt(std::max(variance[k], 0.0)) / kQuarter;
  }
}

/// Computes in double, because the difference of a large float from the mean may overflow a float.
BEVLOC_TARGET_CLONES void shift_and_scale(const Moments& moments, int first_lane,
                                          CellFeatures& features) {
  const LaneDoubles scale = 1.0 / (moments.std + kCellStdEpsilon);
  const BevGrid& grid = features.grid();
  for (int row = 0; row < grid.rows; ++row) {
    float* cell = features.mutable_cell(row, 0) + first_lane;
    for (int col = 0; col < grid.cols; ++col, cell += features.lanes()) {
      const auto value = __builtin_convertvector(lanes(cell), LaneDoubles);
      lanes(cell) = __builtin_convertvector((value - moments.mean) * scale, Lanes);
    }
  }
}

}  // namespace

bool standardise(CellFeatures& features) {
  double greatest_std = 0.0;
  Moments moments;
  for (int first_lane = 0; first_lane < features.lanes(); first_lane += kLanes) {
    find_moments(features, first_lane, moments);
    for (int k = 0; k < kLanes; ++k) {
      if (!std::isfinite(moments.std[k])) return false;  // NaN and infinity propagate to the sums
      greatest_std = std::max(greatest_std, moments.std[k]);
    }
    shift_and_scale(moments, first_lane, features);
  }
  return greatest_std > kLeastStd;
}

}  // namespace bevloc
