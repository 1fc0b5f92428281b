#include "can/vehicle/message_protection.h"

#include <array>

#include "can/e2e/crc8.h"
#include "can/e2e/e2e_p02.h"
#include "can/e2e/e2e_p05.h"

namespace bevloc::can {
namespace {

constexpr auto kSaeTable = crc8_table(0x1D);

/// The bytes that a checksum covers.
struct Covered {
  std::array<uint8_t, kMaxFdLength + 1> bytes{};
  size_t count = 0;

  void add(uint8_t byte) { bytes[count++] = byte; }
  std::span<const uint8_t> view() const { return {bytes.data(), count}; }
};

uint8_t own_counter(const Frame& frame, const MessageProtection& protection) {
  if (!protection.counter) return 0;
  return static_cast<uint8_t>(raw_bits_from(*protection.counter, frame.payload()));
}

Covered covered_by(const Frame& frame, const MessageProtection& protection) {
  Covered covered;
  for (size_t i = 0; i < frame.length; ++i) {
    if (i != protection.checksum_byte) covered.add(frame.data[i]);
  }
  const std::vector<uint16_t>& ids = protection.data_ids;
  if (!ids.empty()) {
    covered.add(static_cast<uint8_t>(ids[own_counter(frame, protection) % ids.size()]));
  }
  return covered;
}

uint8_t checksum_of(const Frame& frame, const MessageProtection& protection) {
  const Covered covered = covered_by(frame, protection);
  if (protection.checksum == ChecksumKind::kCrc8H2f) return crc8_h2f(covered.view());
  if (protection.checksum == ChecksumKind::kCrc8Sae) {
    Crc8Sae crc;
    for (const uint8_t byte : covered.view()) crc.add(byte);
    return crc.value();
  }
  uint8_t sum = 0;
  for (const uint8_t byte : covered.view()) sum ^= byte;
  return sum;
}

E2eProtection profile_of(const MessageProtection& protection, uint8_t counter) {
  const std::vector<uint16_t>& ids = protection.data_ids;
  return {ids[counter % ids.size()],
          protection.checksum == ChecksumKind::kE2eP05 ? E2eProfile::kP05 : E2eProfile::kP02};
}

}  // namespace

void Crc8Sae::add(uint8_t byte) {
  remainder_ = kSaeTable[remainder_ ^ byte];
}

E2eFrame e2e_frame_of(const Frame& frame, const MessageProtection& protection, uint8_t length) {
  if (frame.length != length) return {};
  if (protection.is_profile()) {
    const auto profile = profile_of(protection, 0).profile;
    return e2e_frame_of(frame, profile_of(protection, counter_of(frame, profile)), length);
  }
  E2eFrame checked{.right_length = true, .right_crc = true};
  if (protection.checksum != ChecksumKind::kNone) {
    checked.right_crc = frame.data[protection.checksum_byte] == checksum_of(frame, protection);
  }
  if (!protection.counter) return checked;
  checked.counter = own_counter(frame, protection);
  if (*checked.counter > protection.highest_counter) checked.right_crc = false;
  return checked;
}

void protect(Frame& frame, const MessageProtection& protection, uint8_t counter) {
  if (protection.checksum == ChecksumKind::kE2eP02) {
    return protect_p02(frame, static_cast<uint8_t>(profile_of(protection, counter).data_id),
                       counter);
  }
  if (protection.checksum == ChecksumKind::kE2eP05) {
    return protect_p05(frame, profile_of(protection, counter).data_id, counter);
  }
  if (protection.counter) {
    insert_bits(*protection.counter, counter, {frame.data.data(), frame.length});
  }
  if (protection.checksum == ChecksumKind::kNone) return;
  frame.data[protection.checksum_byte] = checksum_of(frame, protection);
}

}  // namespace bevloc::can
