// Notices when the time stamps of a camera jump although its frames arrive as before.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.h"

namespace bevloc::drivers {

/// The stamp, the arrival and the sequence number of a frame each say how much time has passed
/// since the frame before. If stamp and arrival disagree, the sequence number decides. If the stamp
/// disagrees with the sequence number, the stamps have jumped. If the frame also arrived late, only
/// a jump of more than kTolerated counts. The sum of all jumps is the offset of the stamps.
///
/// If the trigger omits a pulse, more time passes than the sequence numbers show, and the stamps
/// seem to jump. So a large jump is taken back if the lags of the next frames do not fit it. The
/// lag of a frame is the time from its stamp to its arrival. A frame can arrive late, but not
/// early.
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

  /// How often the offset has changed by more than kTolerated. The count never decreases.
  uint64_t jumps() const { return jumps_; }

  /// Forgets everything but jumps(), because the camera starts again.
  void reset();

 private:
  struct Seen {
    Time stamp;
    Time arrival;
    uint64_t sequence = 0;
  };
  /// A jump that the following frames may disprove.
  struct Doubt {
    Duration usual_lag{};  ///< the usual lag before the jump
    Duration offset_before{};
    Duration offset_after{};  ///< the offset if the jump is real
    Duration least_lag{};     ///< the least lag of the frames since the jump
    int frames = 0;           ///< the number of frames since the jump

    bool is_disproved() const;
  };

  void judge(const Seen& frame);
  void add_jump(Duration jump);
  void add_lag(Duration lag);
  void count_jump();

  std::optional<Seen> latest_;
  std::optional<Duration> period_;  ///< from one frame to the next
  Duration usual_lag_{0};           ///< the least lag of the latest frames
  std::optional<Doubt> doubt_;
  Duration offset_{0};
  Duration counted_offset_{0};  ///< the offset after the latest counted jump
  uint64_t jumps_ = 0;
};

}  // namespace bevloc::drivers
