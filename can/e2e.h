// End-to-end protection of the frames of one message, at both ends.
#pragma once

#include <cstdint>
#include <optional>

#include "can/frame.h"

namespace bevloc::can {

enum class E2eProfile : uint8_t {
  kP02,  ///< classic frames (e2e_p02.h); data ids of 8 bits, counters from 0 to 15
  kP05,  ///< FD frames (e2e_p05.h); data ids of 16 bits, counters from 0 to 255
};

/// How a message is protected.
struct E2eProtection {
  uint16_t data_id = 0;
  E2eProfile profile = E2eProfile::kP02;

  bool operator==(const E2eProtection&) const = default;
};

/// Protects the frames of one message, one after the other.
class E2eSender {
 public:
  explicit E2eSender(const E2eProtection& protection) : protection_(protection) {}

  void protect(Frame& frame);

 private:
  E2eProtection protection_;
  uint8_t counter_ = 0;
};

enum class E2eResult : uint8_t {
  kOk,
  kSomeLost,     ///< sound, but frames before it are missing
  kRepeated,     ///< sound, but its counter is that of the last one: not to be used
  kWrongCrc,     ///< damaged, or a frame of another message: not to be used
  kWrongLength,  ///< not to be used
};

constexpr bool is_usable(E2eResult result) {
  return result == E2eResult::kOk || result == E2eResult::kSomeLost;
}

struct E2eCounters {
  uint64_t ok = 0;  ///< usable frames, including those after a loss
  uint64_t repeated = 0;
  uint64_t wrong_crc = 0;
  uint64_t wrong_length = 0;
  uint64_t lost = 0;  ///< frames missing between usable ones, modulo the counter's range each time
};

/// Checks the frames of one message, one after the other. A time-out is the caller's to notice.
class E2eChecker {
 public:
  E2eChecker(const E2eProtection& protection, uint8_t length)
      : protection_(protection), length_(length) {}

  E2eResult check(const Frame& frame);
  const E2eCounters& counters() const { return counters_; }

 private:
  E2eProtection protection_;
  uint8_t length_;
  std::optional<uint8_t> last_counter_;
  E2eCounters counters_;
};

}  // namespace bevloc::can
