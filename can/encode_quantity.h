// Signals that need more than the nearest step.
#pragma once

#include <cmath>

#include "can/signal.h"

namespace bevloc::can {

/// A heading in [0, 360): what rounds up to a full turn is 0, not the largest value.
inline void encode_heading(Frame& frame, const Signal& signal, double heading_deg) {
  const bool full_turn = heading_deg >= 360.0 - 0.5 * signal.scale;
  encode(frame, signal, full_turn ? 0.0 : heading_deg);
}

/// A standard deviation goes up to the next step, so that it never claims more than is known.
inline void encode_sigma(Frame& frame, const Signal& signal, double sigma) {
  constexpr double kRoundingOfTheQuotient = 1e-9;
  encode(frame, signal, std::ceil(sigma / signal.scale - kRoundingOfTheQuotient) * signal.scale);
}

}  // namespace bevloc::can
