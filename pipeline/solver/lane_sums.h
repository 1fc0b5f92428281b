// Sums and products over cells, for sixteen channels at a time. Counts and strides are in floats
// unless they are called cells, and whole multiples of kLanes.
#pragma once

#include <cstddef>

namespace bevloc {

/// Sum of a[i] b[i].
float dot(const float* a, const float* b, int count);

/// out[i] += weight a[i].
void add_weighted(const float* a, float weight, int count, float* out);

/// Per channel: out += weight * sum over `cells` neighbouring cells.
void add_weighted_sum(const float* first, int cells, float weight, int lane_count, float* out);

/// Per channel: mean 0 and deviation nearly 1 over `runs` runs of `cells` cells, `stride` apart:
/// (f - mean) / (std + epsilon), population moments.
void standardise_runs(float* first, int runs, std::ptrdiff_t stride, int cells, int lane_count,
                      float epsilon);

}  // namespace bevloc
