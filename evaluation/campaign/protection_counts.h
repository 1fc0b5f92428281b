// Counts how poses keep their protection levels.
#pragma once

#include <array>
#include <cstdint>

#include "evaluation/campaign/cycle_reader.h"

namespace bevloc::evaluation {

/// Numbers of valid poses, per axis: longitudinal, lateral, yaw.
using PoseCounts = std::array<uint64_t, 3>;

/// Each axis of a pose counts on its own.
struct ProtectionCounts {
  PoseCounts with_level{};  ///< poses with a protection level
  PoseCounts misleading{};  ///< of those: beyond the protection level
  PoseCounts hazardous{};   ///< of those: beyond the alert limit too
  PoseCounts available{};   ///< poses with a protection level under the alert limit

  void add(const JudgedError& pose);
};

}  // namespace bevloc::evaluation
