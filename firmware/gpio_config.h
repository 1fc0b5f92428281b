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
  drivers::LineAddress address;  ///< active: ignition is on
  /// Off for less than this is a bounce or a dip while the engine starts.
  Duration debounce = std::chrono::milliseconds(200);
};

/// Each line may be left out.
struct GpioConfig {
  std::optional<TriggerLineConfig> trigger;
  std::optional<drivers::LineAddress> status_led;
  std::optional<drivers::LineAddress> fault;
  std::optional<IgnitionConfig> ignition;
};

/// Of every line that is configured.
std::vector<drivers::LineAddress> lines_of(const GpioConfig& gpio);

/// Mistakes are reported by the file's YamlMap::finish().
GpioConfig read_gpio(YamlMap yaml);

}  // namespace bevloc::firmware
