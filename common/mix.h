// Computes a hash of a number.
#pragma once

#include <cstdint>

namespace bevloc {

/// The finaliser of SplitMix64 (Steele, Lea and Flood: "Fast Splittable Pseudorandom Number
/// Generators"). Different numbers give different results; 0 gives 0.
constexpr uint64_t mix_bits(uint64_t value) {
  value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
  value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
  return value ^ (value >> 31U);
}

}  // namespace bevloc
