#include "firmware/status_led.h"

#include <string_view>

namespace bevloc::firmware {
namespace {

constexpr Duration kSlot = std::chrono::milliseconds(100);

std::string_view pattern_of(State state) {
  switch (state) {
    case State::kInit:
      return "#---------";
    case State::kAcquiring:
      return "#####-----";
    case State::kTracking:
      return "#";
    case State::kDegraded:
      return "#########-";
    case State::kLost:
      return "#-#-------";
    case State::kFault:
      return "##--";
  }
  return "##--";
}

}  // namespace

bool is_lit(State state, Time now) {
  const std::string_view pattern = pattern_of(state);
  const auto slot = static_cast<size_t>(now.time_since_epoch() / kSlot);
  return pattern[slot % pattern.size()] == '#';
}

}  // namespace bevloc::firmware
