#include "pipeline/solver/standardise.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/target_clones.h"

namespace bevloc {
namespace {

constexpr double kStdEpsilon = 0.01;
/// A channel that varies less than this is constant up to rounding and carries nothing.
constexpr double kLeastStd = 1e-4;

struct Moments {
  double mean = 0.0;
  double std = 0.0;
};

/// One pass in double over the distances from the first value, so that a constant channel comes out
/// as exactly that.
BEVLOC_TARGET_CLONES Moments moments_of(const float* data, int count) {
  constexpr int kSums = 16;
  double sums[kSums] = {};
  double squares[kSums] = {};
  const float origin = data[0];
  const int whole = count / kSums * kSums;
  for (int i = 0; i < whole; i += kSums) {
    for (int k = 0; k < kSums; ++k) {
      const double distance = static_cast<double>(data[i + k]) - origin;
      sums[k] += distance;
      squares[k] += distance * distance;
    }
  }
  double sum = 0.0;
  double square = 0.0;
  for (int i = whole; i < count; ++i) {
    const double distance = static_cast<double>(data[i]) - origin;
    sum += distance;
    square += distance * distance;
  }
  for (int k = 0; k < kSums; ++k) {
    sum += sums[k];
    square += squares[k];
  }
  const double mean = sum / count;
  return {origin + mean, std::sqrt(std::max(square / count - mean * mean, 0.0))};
}

/// In double: a float that is as large as they get would lie beyond them from the mean.
BEVLOC_TARGET_CLONES void shift_and_scale(const float* source, double mean, double scale, int count,
                                          float* target) {
  for (int i = 0; i < count; ++i) target[i] = static_cast<float>((source[i] - mean) * scale);
}

}  // namespace

bool standardise(const FeatureView& features, std::span<float> standardised) {
  const int cells = features.grid.cells();
  const size_t count = static_cast<size_t>(features.channels) * cells;
  assert(standardised.size() == count);
  if (count == 0 || features.data.size() != count) return false;

  double greatest_std = 0.0;
  for (int c = 0; c < features.channels; ++c) {
    const float* source = features.data.data() + static_cast<size_t>(c) * cells;
    float* target = standardised.data() + static_cast<size_t>(c) * cells;
    const Moments moments = moments_of(source, cells);
    if (!std::isfinite(moments.std)) return false;  // a value that is not finite spoils the sums
    greatest_std = std::max(greatest_std, moments.std);
    shift_and_scale(source, moments.mean, 1.0 / (moments.std + kStdEpsilon), cells, target);
  }
  return greatest_std > kLeastStd;
}

}  // namespace bevloc
