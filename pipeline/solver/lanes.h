// The vectors that the solver's inner loops work in: sixteen channels side by side.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace bevloc {

inline constexpr int kLanes = 16;

/// Memory that begins on a cache line, so that no vector straddles two.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};

  CacheLineAllocator() = default;
  template <typename U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}

  T* allocate(size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kAlignment));
  }
  void deallocate(T* memory, size_t) { ::operator delete(memory, kAlignment); }
  bool operator==(const CacheLineAllocator&) const = default;
};

/// Buffers of whole vectors.
using LaneBuffer = std::vector<float, CacheLineAllocator<float>>;

/// Sixteen neighbouring floats at any address.
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float)), aligned(4), may_alias));

using LaneDoubles = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneIntegers = int __attribute__((vector_size(kLanes * sizeof(int)), aligned(4), may_alias));

inline const Lanes& lanes(const float* data) {
  return *reinterpret_cast<const Lanes*>(data);
}
inline Lanes& lanes(float* data) {
  return *reinterpret_cast<Lanes*>(data);
}

/// Pairwise, which is quicker and rounds less than one after the other.
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
