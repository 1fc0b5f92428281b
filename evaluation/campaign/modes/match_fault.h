// A fault of the modelled matcher.
#pragma once

#include <cstdint>

#include "common/se2.h"

namespace bevloc::evaluation {

enum class MatchFaultKind : uint8_t {
  kLocked,      ///< finds a place that is `offset` beside the true one, wherever the search began
  kCreeping,    ///< finds a place that moves away from the true one by `offset` per second
  kLanesAlike,  ///< finds the lane nearest to the prior; lanes are `offset` apart and look alike
  kNoEvidence,  ///< Evidence::kNone
  kSawNothing,  ///< gives zero, as uncertain as the search range, as with dark cameras
  kOldStamps,   ///< framesets carry a time that is `delay_s` too early
};

/// A fault of the matcher, which is active while the fault of its mode is.
struct MatchFault {
  MatchFaultKind kind = MatchFaultKind::kLocked;
  Se2 offset{};  ///< in the frame of the true vehicle
  double delay_s = 0.0;
};

}  // namespace bevloc::evaluation
