// Computes one hash of several numbers.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include "sim/random.h"

namespace bevloc::sim {

/// The result depends on every bit and on the order. One thread.
class Digest {
 public:
  template <typename T>
  void add(T part) {
    if constexpr (std::is_same_v<T, double>) {
      mix(std::bit_cast<uint64_t>(part));
    } else if constexpr (std::is_same_v<T, float>) {
      mix(std::bit_cast<uint32_t>(part));
    } else {
      mix(static_cast<uint64_t>(part));
    }
  }

  uint64_t value() const { return value_; }

 private:
  void mix(uint64_t bits) { value_ = mix_seed(value_ ^ bits); }

  uint64_t value_ = 0;
};

}  // namespace bevloc::sim
