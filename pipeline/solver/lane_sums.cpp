#include "pipeline/solver/lane_sums.h"

#include <cmath>

#include "common/target_clones.h"
#include "pipeline/solver/lanes.h"

namespace bevloc {
namespace {

/// Independent partial sums, to hide the latency of the additions.
constexpr int kSums = 4;

}  // namespace

BEVLOC_TARGET_CLONES float dot(const float* a, const float* b, int count) {
  Lanes sums[kSums] = {};
  int i = 0;
  for (; i + kSums * kLanes <= count; i += kSums * kLanes) {
    for (int k = 0; k < kSums; ++k) {
      sums[k] += lanes(a + i + k * kLanes) * lanes(b + i + k * kLanes);
    }
  }
  for (; i < count; i += kLanes) sums[0] += lanes(a + i) * lanes(b + i);
  return sum_of((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

BEVLOC_TARGET_CLONES void add_weighted(const float* a, float weight, int count, float* out) {
  for (int i = 0; i < count; i += kLanes) lanes(out + i) += weight * lanes(a + i);
}

BEVLOC_TARGET_CLONES void add_weighted_sum(const float* first, int cells, float weight,
                                           int lane_count, float* out) {
  for (int k = 0; k < lane_count; k += kLanes) {
    Lanes sums[kSums] = {};
    int i = 0;
    for (; i + kSums <= cells; i += kSums) {
      for (int j = 0; j < kSums; ++j) sums[j] += lanes(first + (i + j) * lane_count + k);
    }
    for (; i < cells; ++i) sums[0] += lanes(first + i * lane_count + k);
    lanes(out + k) += weight * ((sums[0] + sums[1]) + (sums[2] + sums[3]));
  }
}

BEVLOC_TARGET_CLONES void standardise_runs(float* first, int runs, std::ptrdiff_t stride, int cells,
                                           int lane_count, float epsilon) {
  const float per_cell = 1.0F / static_cast<float>(runs * cells);
  for (int k = 0; k < lane_count; k += kLanes) {
    Lanes mean = {};
    for (int run = 0; run < runs; ++run) {
      for (int i = 0; i < cells; ++i) mean += lanes(first + run * stride + i * lane_count + k);
    }
    mean *= per_cell;
    Lanes variance = {};
    for (int run = 0; run < runs; ++run) {
      for (int i = 0; i < cells; ++i) {
        Lanes& value = lanes(first + run * stride + i * lane_count + k);
        value -= mean;
        variance += value * value;
      }
    }
    Lanes scale = {};
    for (int c = 0; c < kLanes; ++c)
      scale[c] = 1.0F / (std::sqrt(per_cell * variance[c]) + epsilon);
    for (int run = 0; run < runs; ++run) {
      for (int i = 0; i < cells; ++i) lanes(first + run * stride + i * lane_count + k) *= scale;
    }
  }
}

}  // namespace bevloc
