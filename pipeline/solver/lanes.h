// The vectors that the solver's inner loops work in: sixteen channels side by side.
#pragma once

namespace bevloc {

inline constexpr int kLanes = 16;

/// Sixteen neighbouring floats at any address.
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float)), aligned(4), may_alias));

inline const Lanes& lanes(const float* data) {
  return *reinterpret_cast<const Lanes*>(data);
}
inline Lanes& lanes(float* data) {
  return *reinterpret_cast<Lanes*>(data);
}

inline float sum_of(const Lanes& values) {
  float sum = 0.0F;
  for (int i = 0; i < kLanes; ++i) sum += values[i];
  return sum;
}

constexpr int round_up_to_lanes(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

}  // namespace bevloc
