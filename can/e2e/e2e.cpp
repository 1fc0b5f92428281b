#include "can/e2e/e2e.h"

#include "can/e2e/e2e_p02.h"
#include "can/e2e/e2e_p05.h"

namespace bevloc::can {

uint8_t highest_counter(E2eProfile profile) {
  return profile == E2eProfile::kP02 ? 0x0F : 0xFF;
}

uint8_t counter_of(const Frame& frame, E2eProfile profile) {
  return profile == E2eProfile::kP02 ? frame.data[1] & 0x0F : frame.data[2];
}

bool has_valid_crc(const Frame& frame, const E2eProtection& protection) {
  if (protection.profile == E2eProfile::kP05) return has_valid_crc_p05(frame, protection.data_id);
  return has_valid_crc_p02(frame, static_cast<uint8_t>(protection.data_id));
}

void E2eSender::protect(Frame& frame) {
  if (protection_.profile == E2eProfile::kP05) {
    protect_p05(frame, protection_.data_id, counter_);
  } else {
    protect_p02(frame, static_cast<uint8_t>(protection_.data_id), counter_);
  }
  counter_ = (counter_ + 1) & highest_counter(protection_.profile);
}

E2eResult E2eChecker::check(const Frame& frame) {
  if (frame.length != length_) {
    ++counters_.wrong_length;
    return E2eResult::kWrongLength;
  }
  if (!has_valid_crc(frame, protection_)) {
    ++counters_.wrong_crc;
    return E2eResult::kWrongCrc;
  }
  const uint8_t counter = counter_of(frame, protection_.profile);
  if (last_counter_ == counter) {
    ++counters_.repeated;
    return E2eResult::kRepeated;
  }
  const int lost =
      last_counter_ ? (counter - *last_counter_ - 1) & highest_counter(protection_.profile) : 0;
  last_counter_ = counter;
  ++counters_.ok;
  counters_.lost += static_cast<uint64_t>(lost);
  return lost == 0 ? E2eResult::kOk : E2eResult::kSomeLost;
}

}  // namespace bevloc::can
