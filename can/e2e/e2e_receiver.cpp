#include "can/e2e/e2e_receiver.h"

#include <algorithm>

namespace bevloc::can {

E2eReceiver::E2eReceiver(const E2eProtection& protection, uint8_t length,
                         const E2eReceiverParameters& parameters)
    : protection_(protection),
      length_(length),
      parameters_(parameters),
      machine_(parameters.state) {}

bool E2eReceiver::accept(const ReceivedFrame& received) {
  add_missing_cycles(received.received);
  const E2eCheck result = check(received);
  const bool valid = machine_.add(result) == E2eState::kValid;
  if (result != E2eCheck::kOk) return false;
  ++(valid ? counters_.ok : counters_.not_valid);
  return valid;
}

E2eCheck E2eReceiver::check(const ReceivedFrame& received) {
  if (received.frame.length != length_) {
    ++counters_.wrong_length;
    return E2eCheck::kError;
  }
  if (!has_valid_crc(received.frame, protection_)) {
    ++counters_.wrong_crc;
    return E2eCheck::kError;
  }
  const E2eCheck result =
      check_counter(counter_of(received.frame, protection_.profile), received.received);
  if (result == E2eCheck::kRepeated) ++counters_.repeated;
  if (result == E2eCheck::kWrongSequence) ++counters_.wrong_sequence;
  return result;
}

E2eCheck E2eReceiver::check_counter(uint8_t counter, Time received) {
  const int steps = counter_ ? delta(counter, *counter_) : 1;
  if (steps == 0 && !other_counter_) return E2eCheck::kRepeated;
  const Duration silence = counter_ ? received - in_sequence_ : Duration::zero();
  const bool silent = silence >= parameters_.silent_cycles * parameters_.cycle;
  const bool continues =
      steps > 0 && steps <= parameters_.max_delta_counter + silence / parameters_.cycle;
  // The allowed step grows with time. Without this condition every counter would pass some time
  // after the sender of the sequence has gone.
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

bool E2eReceiver::follow(uint8_t counter) {
  const bool next = other_counter_ && delta(counter, *other_counter_) == 1;
  other_run_ = next ? other_run_ + 1 : 1;
  other_counter_ = counter;
  return other_run_ >= parameters_.sync_frames;
}

int E2eReceiver::delta(uint8_t counter, uint8_t before) const {
  return (counter - before) & highest_counter(protection_.profile);
}

void E2eReceiver::add_missing_cycles(Time received) {
  const Duration cycle = parameters_.cycle;
  const int64_t cycles = arrival_ ? (received - *arrival_ + cycle / 2) / cycle : 0;
  const int64_t missing = std::min<int64_t>(cycles - 1, parameters_.state.window);
  for (int64_t i = 0; i < missing; ++i) machine_.add(E2eCheck::kNoNewData);
  arrival_ = received;
}

}  // namespace bevloc::can
