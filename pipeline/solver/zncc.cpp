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

BEVLOC_TARGET_CLONES RowSums sum_row(const float* row, int count) {
  Lanes value = {};
  Lanes square = {};
  for (int i = 0; i < count; i += kLanes) {
    value += lanes(row + i);
    square += lanes(row + i) * lanes(row + i);
  }
  return {sum_of(value), sum_of(square)};
}

}  // namespace

FeatureMoments moments(double sum, double square_sum, double count) {
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(square_sum / count - mean * mean, 0.0))};
}

FeatureMoments moments_of(const CellFeatures& features) {
  double value = 0.0;
  double square = 0.0;
  for (int row = 0; row < features.grid().rows; ++row) {
    const RowSums sums = sum_row(features.cell(row, 0), features.grid().cols * features.lanes());
    value += sums.value;
    square += sums.square;
  }
  return moments(value, square, static_cast<double>(features.grid().cells()) * features.channels());
}

double zncc(double product_sum, const FeatureMoments& a, const FeatureMoments& b, double count) {
  const double deviations = a.deviation * b.deviation;
  return deviations > 0.0 ? (product_sum / count - a.mean * b.mean) / deviations : 0.0;
}

}  // namespace bevloc
