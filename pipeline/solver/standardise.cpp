#include "pipeline/solver/standardise.h"

#include <algorithm>
#include <cmath>

#include "common/target_clones.h"

namespace bevloc {
namespace {

constexpr double kStdEpsilon = 0.01;
/// A channel that varies less than this is constant up to rounding and carries nothing.
constexpr double kLeastStd = 1e-4;

/// Sixteen neighbouring channels.
struct Moments {
  LaneDoubles mean;
  LaneDoubles std;
};

/// One pass over the distances from the first cell, so that a constant channel comes out as exactly
/// that. Their quarters: twice the largest float would be beyond floats.
BEVLOC_TARGET_CLONES void find_moments(const CellFeatures& features, int first_lane,
                                       Moments& moments) {
  constexpr float kPart = 0.25F;
  const BevGrid& grid = features.grid();
  const Lanes origin = kPart * lanes(features.cell(0, 0) + first_lane);
  // Two cells at a time, to hide the latency of the additions.
  LaneDoubles sums[2] = {};
  LaneDoubles squares[2] = {};
  for (int row = 0; row < grid.rows; ++row) {
    const float* cell = features.cell(row, 0) + first_lane;
    for (int col = 0; col < grid.cols; ++col, cell += features.lanes()) {
      const Lanes distance = kPart * lanes(cell) - origin;
      const auto exact = __builtin_convertvector(distance, LaneDoubles);
      sums[col % 2] += exact;
      squares[col % 2] += exact * exact;
    }
  }
  const LaneDoubles sum = sums[0] + sums[1];
  const LaneDoubles square = squares[0] + squares[1];
  const LaneDoubles mean = sum / grid.cells();
  const LaneDoubles variance = square / grid.cells() - mean * mean;
  moments.mean = (__builtin_convertvector(origin, LaneDoubles) + mean) / kPart;
  for (int k = 0; k < kLanes; ++k) {
    moments.std[k] = std::sqrt(std::max(variance[k], 0.0)) / kPart;
  }
}

/// In double: a float that is as large as they get would lie beyond them from the mean.
BEVLOC_TARGET_CLONES void shift_and_scale(const Moments& moments, int first_lane,
                                          CellFeatures& features) {
  const LaneDoubles scale = 1.0 / (moments.std + kStdEpsilon);
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
      if (!std::isfinite(moments.std[k])) return false;  // a value that is not spoils the sums
      greatest_std = std::max(greatest_std, moments.std[k]);
    }
    shift_and_scale(moments, first_lane, features);
  }
  return greatest_std > kLeastStd;
}

}  // namespace bevloc
