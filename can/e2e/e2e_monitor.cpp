#include "can/e2e/e2e_monitor.h"

#include <algorithm>

namespace bevloc::can {

E2eReceiverParameters gnss_receiver_parameters(Duration cycle) {
  return {.cycle = cycle, .state = {.window = 20, .min_ok_invalid = 2}};
}

E2eFrame e2e_frame_of(const Frame& frame, const E2eProtection& protection, uint8_t length) {
  E2eFrame checked{.right_length = frame.length == length};
  if (!checked.right_length) return checked;
  checked.right_crc = has_valid_crc(frame, protection);
  checked.counter = counter_of(frame, protection.profile);
  return checked;
}

bool E2eMonitor::accept(const E2eFrame& frame, Time received) {
  add_missing_cycles(received);
  const E2eCheck result = check(frame, received);
  const bool valid = machine_.add(result) == E2eState::kValid;
  if (result != E2eCheck::kOk) return false;
  ++(valid ? counters_.ok : counters_.not_valid);
  return valid;
}

E2eCheck E2eMonitor::check(const E2eFrame& frame, Time received) {
  if (!frame.right_length) {
    ++counters_.wrong_length;
    return E2eCheck::kError;
  }
  if (!frame.right_crc) {
    ++counters_.wrong_crc;
    return E2eCheck::kError;
  }
  if (!frame.counter) return E2eCheck::kOk;
  const E2eCheck result = check_counter(*frame.counter, received);
  if (result == E2eCheck::kRepeated) ++counters_.repeated;
  if (result == E2eCheck::kWrongSequence) ++counters_.wrong_sequence;
  return result;
}

E2eCheck E2eMonitor::check_counter(uint8_t counter, Time received) {
  const int steps = counter_ ? delta(counter, *counter_) : 1;
  if (steps == 0 && !other_counter_) return E2eCheck::kRepeated;
  const Duration silence = counter_ ? received - in_sequence_ : Duration::zero();
  const bool silent = silence >= kSilentCycles * parameters_.cycle;
  const bool continues = steps > 0 && steps <= kMaxDeltaCounter + silence / parameters_.cycle;
  // The allowed step grows with time. Without this condition, any counter would be accepted some
  // time after the sender of the sequence has stopped.
  const bool undisputed = !silent || !other_counter_;
  if (continues && undisputed) {
    counters_.lost += static_cast<uint64_t>(steps - 1);
  } else {
    const E2eCheck refused = steps == 0 ? E2eCheck::kRepeated : E2eCheck::kWrongSequence;
    if (!follow(counter) || !silent) return refused;
    machine_.clear_window();
  }
  counter_ = counter;
  in_sequence_ = received;
  other_counter_.reset();
  return E2eCheck::kOk;
}

bool E2eMonitor::follow(uint8_t counter) {
  const bool next = other_counter_ && delta(counter, *other_counter_) == 1;
  other_run_ = next ? other_run_ + 1 : 1;
  other_counter_ = counter;
  return other_run_ >= kSyncFrames;
}

void E2eMonitor::add_missing_cycles(Time received) {
  const Duration cycle = parameters_.cycle;
  const int64_t cycles = arrival_ ? (received - *arrival_ + cycle / 2) / cycle : 0;
  const int64_t missing = std::min<int64_t>(cycles - 1, parameters_.state.window);
  for (int64_t i = 0; i < missing; ++i) machine_.add(E2eCheck::kNoNewData);
  arrival_ = received;
}

}  // namespace bevloc::can
