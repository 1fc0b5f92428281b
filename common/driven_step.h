// The motion that odometry measured in a short interval.
#pragma once

#include "common/se2.h"
#include "common/time.h"

namespace bevloc {

/// The vehicle's motion between two times, from odometry.
struct DrivenStep {
  Time from;
  Time to;
  Se2 motion;  ///< pose at `to` in the vehicle frame at `from`
};

}  // namespace bevloc
