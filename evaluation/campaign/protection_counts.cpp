#include "evaluation/campaign/protection_counts.h"

#include <cmath>

#include "common/alert_limits.h"

namespace bevloc::evaluation {

void ProtectionCounts::add(const JudgedError& pose) {
  for (int i = 0; i < 3; ++i) {
    const double level = pose.protection(i);
    if (!std::isfinite(level)) continue;
    const auto axis = static_cast<size_t>(i);
    const double error = std::abs(pose.error(i));
    ++with_level[axis];
    if (level < kFreewayAlertLimits(i)) ++available[axis];
    if (error <= level) continue;
    ++misleading[axis];
    if (error > kFreewayAlertLimits(i)) ++hazardous[axis];
  }
}

}  // namespace bevloc::evaluation
