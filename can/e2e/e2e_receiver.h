// Receives one protected message: checks each frame and decides whether it can be used.
#pragma once

#include "can/e2e/e2e_monitor.h"

namespace bevloc::can {

/// An E2eMonitor for the profiles P02 and P05. One thread.
class E2eReceiver {
 public:
  E2eReceiver(const E2eProtection& protection, uint8_t length,
              const E2eReceiverParameters& parameters);

  /// Returns whether the frame can be used: it passed the check, and the state is VALID.
  bool accept(const ReceivedFrame& received);

  E2eState state() const { return monitor_.state(); }
  bool has_second_sender() const { return monitor_.has_second_sender(); }
  const E2eCounters& counters() const { return monitor_.counters(); }

 private:
  E2eProtection protection_;
  uint8_t length_;
  E2eMonitor monitor_;
};

/// Checks the protection of a frame, whose message has `length` bytes.
E2eFrame e2e_frame_of(const Frame& frame, const E2eProtection& protection, uint8_t length);

}  // namespace bevloc::can
