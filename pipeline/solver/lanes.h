// The vectors that the solver's inner loops work in: sixteen channels side by side.
#pragma once

/// Compiles a function for several generations of x86-64; the loader picks the best one. Not with
/// sanitizers: the loader picks before they are set up.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BEVLOC_VECTOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define BEVLOC_VECTOR_CLONES
#endif

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
