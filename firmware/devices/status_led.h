// Blink patterns of the status LED.
#pragma once

#include <cstdint>

#include "common/health_state.h"
#include "common/time.h"

namespace bevloc::firmware {

/// Whether the LED is lit at `now`. The patterns repeat, and each character is a tenth of a second:
///   INIT        #---------  one flash per second
///   ACQUIRING   #####-----  slow blinking
///   TRACKING    ##########  steady
///   DEGRADED    #########-  steady with one short gap per second
///   LOST        #-#-------  two flashes per second
///   FAULT       ##--        fast blinking
bool is_lit(HealthState state, Time now);

/// Decides which state the LED shows. It shows LOST for a second after a loss, because LOST itself
/// lasts only one bus cycle before ACQUIRING follows. One thread.
class ShownState {
 public:
  static constexpr Duration kLostShown = std::chrono::seconds(1);

  /// Returns the state to show. `lost` says how often the pose was lost.
  HealthState of(HealthState state, uint64_t lost, Time now);

 private:
  uint64_t lost_ = 0;
  Time lost_shown_until_ = Time::min();
};

}  // namespace bevloc::firmware
