#include "firmware/config/clock_config.h"

#include "firmware/config/config_milliseconds.h"

namespace bevloc::firmware {

ClockConfig read_clock_section(std::optional<YamlMap> yaml) {
  ClockConfig clock;
  if (!yaml) return clock;
  clock.source =
      yaml->require_choice<can::TimeSource>("source", {{"none", can::TimeSource::kFreeRunning},
                                                       {"ntp", can::TimeSource::kNtp},
                                                       {"ptp", can::TimeSource::kPtp},
                                                       {"gnss", can::TimeSource::kGnss}});
  clock.max_error =
      optional_milliseconds(*yaml, "max_error_ms", clock.max_error, between(0.1, 1000.0));
  return clock;
}

}  // namespace bevloc::firmware
