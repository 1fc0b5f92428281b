// Sums and products over cells, for kLanes channels at a time. Counts and strides are in floats and
// multiples of kLanes; `cells` counts cells.
#pragma once

#include <cstddef>

namespace bevloc {

/// Sum of a[i] * b[i] over `count` floats.
float dot(const float* a, const float* b, int count);

/// out[i] += weight * a[i].
void add_weighted(const float* a, float weight, int count, float* out);

/// Per lane: out += weight * sum over `cells` neighbouring cells, starting at `first`.
void add_weighted_sum(const float* first, int cells, float weight, int lane_count, float* out);

/// Standardises each lane in place: f <- (f - mean) / (std + epsilon), with the moments of the
/// population of `runs` runs of `cells` neighbouring cells. Runs start `stride` floats apart.
void standardise_runs(float* first, int runs, std::ptrdiff_t stride, int cells, int lane_count,
                      float epsilon);

}  // namespace bevloc
