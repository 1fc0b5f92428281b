// Notices that the cameras no longer expose together.
#pragma once

#include <bit>
#include <cstdint>

#include "pipeline/calibration/rig.h"

namespace bevloc::drivers {

/// Cameras in step are in one set; cameras out of step are in sets of their own, one after the
/// other within a period, which have no camera in common. A camera that only loses frames makes no
/// such sets. Pure logic, told of each set in the order of time.
class SplitMonitor {
 public:
  /// So many of the latest kMemory sets, each without a camera of the one before: a split.
  static constexpr int kSplitSets = 3;
  static constexpr int kMemory = 16;

  /// `found`: the cameras in the set, also when it is not given out because they are too few.
  void add(CameraMask found) {
    const bool parted = previous_.any() && (previous_ & found).none();
    history_ = static_cast<uint16_t>((history_ << 1U) | (parted ? 1U : 0U));
    previous_ = found;
    ++sets_;
  }

  bool split() const { return std::popcount(history_) >= kSplitSets; }
  /// How many it was told of.
  uint64_t sets() const { return sets_; }

 private:
  uint16_t history_ = 0;  ///< kMemory bits, the latest set is the lowest
  CameraMask previous_;
  uint64_t sets_ = 0;
};

}  // namespace bevloc::drivers
