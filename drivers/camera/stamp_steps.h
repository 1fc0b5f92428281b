// Notices when the time stamps of a camera jump although its frames arrive as before.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::drivers {

/// The stamp, the arrival and the sequence number of a frame each say how much time has passed
/// since the frame before. If stamp and arrival disagree, the sequence number decides. A stamp
/// that says another time is wrong: the stamps have jumped. If the frame also arrived late, only a
/// jump of more than kTolerated counts. The sum of all jumps is the offset of the stamps.
///
/// This class cannot find stamps that were wrong from the start. StampMonitor finds them when the
/// vehicle drives through a bend.
/// Allocates nothing. One thread.
class StampSteps {
 public:
  /// The largest offset that is no fault.
  static constexpr Duration kTolerated = std::chrono::milliseconds(40);

  /// Adds a frame. Returns whether its stamp is off by more than kTolerated.
  bool add(Time stamp, Time arrival, uint64_t sequence);

  Duration offset() const { return offset_; }

  /// Forgets everything, because the camera starts again.
  void reset() { *this = StampSteps(); }

 private:
  struct Seen {
    Time stamp;
    Time arrival;
    uint64_t sequence = 0;
  };

  void judge(const Seen& frame);

  std::optional<Seen> latest_;
  std::optional<Duration> period_;  ///< from one frame to the next
  Duration offset_{0};
};

}  // namespace bevloc::drivers
