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

/// Two passes in double, so that a constant channel comes out as exactly that.
BEVLOC_TARGET_CLONES Moments moments_of(const float* data, int count) {
  constexpr int kSums = 8;
  double sums[kSums] = {};
  const int whole = count / kSums * kSums;
  for (int i = 0; i < whole; i += kSums) {
    for (int k = 0; k < kSums; ++k) sums[k] += data[i + k];
  }
  double sum = 0.0;
  for (int i = whole; i < count; ++i) sum += data[i];
  for (double part : sums) sum += part;
  const double mean = sum / count;

  double squares[kSums] = {};
  for (int i = 0; i < whole; i += kSums) {
    for (int k = 0; k < kSums; ++k) squares[k] += (data[i + k] - mean) * (data[i + k] - mean);
  }
  double square = 0.0;
  for (int i = whole; i < count; ++i) square += (data[i] - mean) * (data[i] - mean);
  for (double part : squares) square += part;
  return {mean, std::sqrt(square / count)};
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
    const double scale = 1.0 / (moments.std + kStdEpsilon);
    for (int i = 0; i < cells; ++i) {
      target[i] = static_cast<float>((source[i] - moments.mean) * scale);
    }
  }
  return greatest_std > kLeastStd;
}

}  // namespace bevloc
