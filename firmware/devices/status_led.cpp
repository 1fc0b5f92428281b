#include "firmware/devices/status_led.h"

#include <string_view>

namespace bevloc::firmware {
namespace {

constexpr Duration kSlot = std::chrono::milliseconds(100);

std::string_view pattern_of(HealthState state) {
  switch (state) {
    case HealthState::kInit:
      return "#---------";
    case HealthState::kAcquiring:
      return "#####-----";
    case HealthState::kTracking:
      return "#";
    case HealthState::kDegraded:
      return "#########-";
    case HealthState::kLost:
      return "#-#-------";
    case HealthState::kFault:
      return "##--";
  }
  return "##--";
}

}  // namespace

HealthState ShownState::of(HealthState state, uint64_t lost, Time now) {
  if (lost != lost_) lost_shown_until_ = now + kLostShown;
  lost_ = lost;
  return state == HealthState::kAcquiring && now < lost_shown_until_ ? HealthState::kLost : state;
}

bool is_lit(HealthState state, Time now) {
  const std::string_view pattern = pattern_of(state);
  const auto slot = static_cast<size_t>(now.time_since_epoch() / kSlot);
  return pattern[slot % pattern.size()] == '#';
}

}  // namespace bevloc::firmware
