// Detects that the cameras no longer expose at the same time.
#pragma once

#include <bit>
#include <cstdint>

#include "common/cameras.h"

namespace bevloc::drivers {

/// Synchronized cameras are all in one frameset. Unsynchronized cameras give several framesets per
/// period, and consecutive ones have no camera in common. Lost frames do not give such framesets.
/// One thread.
class SplitMonitor {
 public:
  /// The cameras count as split when at least kSplitSets of the latest kMemory framesets had no
  /// camera in common with the frameset before them.
  static constexpr int kSplitSets = 3;
  static constexpr int kMemory = 16;

  /// Adds the cameras of the next frameset, also when it is not emitted because it has too few.
  void add(CameraMask found) {
    const bool disjoint = previous_.any() && (previous_ & found).none();
    history_ = static_cast<uint16_t>((history_ << 1U) | (disjoint ? 1U : 0U));
    previous_ = found;
    ++sets_;
  }

  bool split() const { return std::popcount(history_) >= kSplitSets; }
  /// Number of framesets that were added.
  uint64_t sets() const { return sets_; }

 private:
  uint16_t history_ = 0;  ///< kMemory bits; the lowest bit is the latest frameset
  CameraMask previous_;
  uint64_t sets_ = 0;
};

}  // namespace bevloc::drivers
