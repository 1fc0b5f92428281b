#include "pipeline/solver/zncc.h"

#include <algorithm>
#include <cmath>

#include "common/target_clones.h"

namespace bevloc {
namespace {

struct RowSums {
  float value;
  float square;
};

/// Sums over `cells` cells that are `step` floats apart, and over all lanes.
BEVLOC_TARGET_CLONES RowSums sum_row(const float* cell, int cells, int step, int lane_count) {
  Lanes value = {};
  Lanes square = {};
  for (int i = 0; i < cells; ++i, cell += step) {
    for (int k = 0; k < lane_count; k += kLanes) {
      value += lanes(cell + k);
      square += lanes(cell + k) * lanes(cell + k);
    }
  }
  return {sum_of(value), sum_of(square)};
}

}  // namespace

FeatureMoments moments(double sum, double square_sum, double count) {
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(square_sum / count - mean * mean, 0.0))};
}

FeatureMoments moments_of(const CellFeatures& features, const CellLattice& lattice) {
  const BevGrid& grid = features.grid();
  const int lane_count = features.lanes();
  double value = 0.0;
  double square = 0.0;
  for (int row = 0; row < grid.rows; ++row) {
    const RowSums sums =
        sum_row(features.cell(row, lattice.first_col(row)), lattice.cells(row, grid.cols),
                lattice.step * lane_count, lane_count);
    value += sums.value;
    square += sums.square;
  }
  return moments(value, square, static_cast<double>(lattice.cells(grid)) * features.channels());
}

double zncc(double product_sum, const FeatureMoments& a, const FeatureMoments& b, double count) {
  const double deviations = a.deviation * b.deviation;
  return deviations > 0.0 ? (product_sum / count - a.mean * b.mean) / deviations : 0.0;
}

}  // namespace bevloc
