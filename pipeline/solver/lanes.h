// SIMD vectors for the solver's inner loops: kLanes channels side by side.
#pragma once

#include "common/cache_line_allocator.h"

namespace bevloc {

inline constexpr int kLanes = 16;

/// A buffer of whole vectors, aligned to cache lines.
using LaneBuffer = CacheLineVector<float>;

/// kLanes neighbouring floats, at any address.
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float)), aligned(4), may_alias));

using LaneDoubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneIntegers = int __attribute__((vector_size(kLanes * sizeof(int)), aligned(4), may_alias));

/// The kLanes floats at `data` as one vector.
inline const Lanes& lanes(const float* data) {
  return *reinterpret_cast<const Lanes*>(data);
}
inline Lanes& lanes(float* data) {
  return *reinterpret_cast<Lanes*>(data);
}

/// Adds all lanes pairwise, which is faster and rounds less than one after the other.
inline float sum_of(const Lanes& values) {
  const auto eight = __builtin_shufflevector(values, values, 0, 1, 2, 3, 4, 5, 6, 7) +
                     __builtin_shufflevector(values, values, 8, 9, 10, 11, 12, 13, 14, 15);
  const auto four = __builtin_shufflevector(eight, eight, 0, 1, 2, 3) +
                    __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
  return (four[0] + four[2]) + (four[1] + four[3]);
}

constexpr int round_up_to_lanes(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

}  // namespace bevloc
