// The grid of candidate corrections (hypotheses) that a solver scores.
#pragma once

#include "common/se2.h"

namespace bevloc {

/// Equally spaced hypotheses from -farthest() to +farthest(). farthest() is the multiple of `step`
/// that is nearest to `range`; a tie rounds up, so it may exceed the range by half a step.
struct HypothesisAxis {
  double range = 0.0;
  double step = 0.0;

  int count() const { return 2 * half_count() + 1; }
  int half_count() const { return static_cast<int>(range / step + 0.5); }
  double value(int i) const { return (i - half_count()) * step; }
  double farthest() const { return half_count() * step; }

  bool operator==(const HypothesisAxis&) const = default;
};

/// Hypotheses for the correction dT = (x, y, yaw). The defaults are the paper's: 21 x 11 x 21.
struct HypothesisGrid {
  HypothesisAxis x_m{2.0, 0.2};
  HypothesisAxis y_m{1.0, 0.2};
  HypothesisAxis yaw_rad{radians(2.0), radians(0.2)};

  int count() const { return x_m.count() * y_m.count() * yaw_rad.count(); }

  bool operator==(const HypothesisGrid&) const = default;
};

}  // namespace bevloc
