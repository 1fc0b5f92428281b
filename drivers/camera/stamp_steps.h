// Notices when the time stamps of a camera jump although its frames arrive as before.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::drivers {

/// A frame's stamp, its arrival and its sequence number tell three times since the frame before.
/// If stamp and arrival disagree, the sequence number decides: a frame that was delivered late has
/// the right stamp, and a stamp that jumps belongs to a frame that arrived when it should. The sum
/// of the jumps is the offset of the stamps since start().
///
/// It finds nothing that was wrong from the start; StampMonitor compares stamps with the vehicle's
/// motion. Allocates nothing. One thread.
class StampSteps {
 public:
  /// The largest offset that is no fault.
  static constexpr Duration kTolerated = std::chrono::milliseconds(40);

  /// Adds a frame. Returns whether its stamp is off by more than kTolerated.
  bool add(Time stamp, Time arrival, uint64_t sequence);

  Duration offset() const { return offset_; }

  /// Forgets everything: the camera starts again.
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
