// The section `gpio` of the configuration file.
#pragma once

#include <optional>
#include <vector>

#include "common/strict_yaml.h"
#include "drivers/gpio/gpio.h"
#include "drivers/trigger/trigger.h"

namespace bevloc::firmware {

struct TriggerLineConfig {
  drivers::LineAddress address;
  drivers::TriggerConfig timing;
};

struct IgnitionConfig {
  drivers::LineAddress address;  ///< active while the ignition is on
  /// Shorter interruptions are ignored, such as contact bounce, or a voltage dip while the engine
  /// starts.
  Duration debounce = std::chrono::milliseconds(200);
};

/// The lines, each of which is optional.
struct GpioConfig {
  std::optional<TriggerLineConfig> trigger;
  std::optional<drivers::LineAddress> status_led;
  std::optional<drivers::LineAddress> fault;
  std::optional<IgnitionConfig> ignition;
};

/// Returns the addresses of all configured lines.
std::vector<drivers::LineAddress> lines_of(const GpioConfig& gpio);

/// Reads the section. YamlMap::finish() reports mistakes.
GpioConfig read_gpio(YamlMap yaml);

}  // namespace bevloc::firmware
