#include "can/e2e/e2e_receiver.h"

namespace bevloc::can {

E2eReceiver::E2eReceiver(const E2eProtection& protection, uint8_t length,
                         const E2eReceiverParameters& parameters)
    : protection_(protection),
      length_(length),
      monitor_(highest_counter(protection.profile), parameters) {}

bool E2eReceiver::accept(const ReceivedFrame& received) {
  return monitor_.accept(e2e_frame_of(received.frame, protection_, length_), received.received);
}

E2eFrame e2e_frame_of(const Frame& frame, const E2eProtection& protection, uint8_t length) {
  E2eFrame checked{.right_length = frame.length == length};
  if (!checked.right_length) return checked;
  checked.right_crc = has_valid_crc(frame, protection);
  checked.counter = counter_of(frame, protection.profile);
  return checked;
}

}  // namespace bevloc::can
