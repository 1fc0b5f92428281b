// Encodes headings, standard deviations and bounds, which are not rounded to the nearest step.
#pragma once

#include <cmath>

#include "can/messages/signal.h"

namespace bevloc::can {

/// Encodes a heading in [0, 360) degrees. A value that rounds up to 360 is encoded as 0, and not as
/// the largest value of the signal.
inline void encode_heading(Frame& frame, const Signal& signal, double heading_deg) {
  const bool full_turn = heading_deg >= 360.0 - 0.5 * signal.scale;
  encode(frame, signal, full_turn ? 0.0 : heading_deg);
}

/// Encodes a standard deviation. It is rounded up to the next step, so that the sent value is never
/// smaller than the real one.
inline void encode_sigma(Frame& frame, const Signal& signal, double sigma) {
  constexpr double kDivisionError = 1e-9;  // a whole number of steps must not become one step more
  encode(frame, signal, std::ceil(sigma / signal.scale - kDivisionError) * signal.scale);
}

/// Encodes an upper bound of a magnitude. It is rounded up. A bound beyond the range of the signal
/// becomes SNA, because the largest value would promise too much.
inline void encode_bound(Frame& frame, const Signal& signal, double bound) {
  const bool in_range = bound >= 0.0 && bound <= signal.max;
  if (in_range)
    encode_sigma(frame, signal, bound);
  else
    insert_raw(frame, signal, signal.sna_raw());
}

}  // namespace bevloc::can
