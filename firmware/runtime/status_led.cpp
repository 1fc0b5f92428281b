#include "firmware/runtime/status_led.h"

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

bool is_lit(HealthState state, Time now) {
  const std::string_view pattern = pattern_of(state);
  const auto slot = static_cast<size_t>(now.time_since_epoch() / kSlot);
  return pattern[slot % pattern.size()] == '#';
}

}  // namespace bevloc::firmware
