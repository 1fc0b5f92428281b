// Reads bevloc's pose from the CAN bus in C++: bevloc.h with the types of the standard library.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

extern "C" {
#include "bevloc.h"
}

namespace bevloc::consumer {

using AlertLimits = ::bevloc_alert_limits;
using Pose = ::bevloc_pose;
using Answer = enum ::bevloc_answer;

/// Checks, assembles and judges what bevlocd sends (bevloc.h says how). One thread; does not
/// allocate. Times are of any clock that does not jump.
class Receiver {
 public:
  explicit Receiver(const AlertLimits& limits, uint32_t base_id = BEVLOC_LOCALIZER_BASE) {
    bevloc_init(&receiver_, base_id, limits);
  }

  /// Takes any frame of the bus. `now` says when it arrived, not when you read it. Returns true
  /// when it completes a pose.
  bool receive(uint32_t id, std::span<const uint8_t> data, std::chrono::microseconds now) {
    return bevloc_receive(&receiver_, id, data.data(), data.size(), count(now));
  }

  /// Says whether the latest pose may be used now, and if not, why.
  Answer answer(std::chrono::microseconds now) const {
    return ::bevloc_answer(&receiver_, count(now));
  }
  /// The latest pose, if it may be used now.
  std::optional<Pose> usable_pose(std::chrono::microseconds now) const {
    if (answer(now) != BEVLOC_USABLE) return std::nullopt;
    return receiver_.pose;
  }

  /// When the images behind the latest pose were taken, UTC modulo 2^32 us, if that is known.
  std::optional<uint32_t> capture_utc_us(std::chrono::microseconds now) const {
    uint32_t utc_us = 0;
    if (!bevloc_capture_utc(&receiver_, count(now), &utc_us)) return std::nullopt;
    return utc_us;
  }

  int state() const { return receiver_.state; }
  /// Why the state is not better, as bits: why() & BEVLOC_WHY(BEVLOC_LOC_Status_Why_GnssMissing).
  uint32_t why() const { return receiver_.why; }
  int time_source() const { return receiver_.time_source; }
  uint16_t map_id() const { return receiver_.map_id; }
  const Pose& latest() const { return receiver_.pose; }
  const ::bevloc_counters& counters() const { return receiver_.counters; }

 private:
  static uint64_t count(std::chrono::microseconds time) {
    return static_cast<uint64_t>(time.count());
  }

  ::bevloc_receiver receiver_{};
};

inline std::string_view name_of(Answer answer) {
  return bevloc_answer_name(answer);
}

}  // namespace bevloc::consumer
