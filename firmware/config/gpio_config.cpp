#include "firmware/config/gpio_config.h"

#include "firmware/config/config_milliseconds.h"

namespace bevloc::firmware {
namespace {

using drivers::LineAddress;

LineAddress read_address(YamlMap& yaml) {
  const Wanted<std::string> named = not_empty("a name");
  LineAddress address;
  address.chip = yaml.require<std::string>("chip", named);
  address.line = yaml.require<std::string>("line", named);
  address.active_low =
      yaml.optional_choice<bool>("active", false, {{"high", false}, {"low", true}});
  return address;
}

TriggerLineConfig read_trigger(YamlMap& yaml) {
  TriggerLineConfig trigger;
  trigger.address = read_address(yaml);
  // The rate is 0 if the key is missing or wrong, which finish() reports.
  const double rate_hz = yaml.require<double>("rate_hz", between(1.0, 60.0));
  if (rate_hz > 0.0) trigger.timing.period = from_seconds(1.0 / rate_hz);
  trigger.timing.pulse_width =
      optional_milliseconds(yaml, "pulse_ms", trigger.timing.pulse_width, between(0.01, 100.0));
  if (2 * trigger.timing.pulse_width >= trigger.timing.period) {
    yaml.reject("pulse_ms", "half a period of rate_hz or more", "less than half a period");
  }
  return trigger;
}

IgnitionConfig read_ignition(YamlMap& yaml) {
  IgnitionConfig ignition;
  ignition.address = read_address(yaml);
  ignition.debounce =
      optional_milliseconds(yaml, "debounce_ms", ignition.debounce, between(0.0, 10'000.0));
  return ignition;
}

/// Reports a line that is already configured for another purpose.
void reject_if_taken(YamlMap& yaml, const LineAddress& address, const GpioConfig& others) {
  for (const LineAddress& other : lines_of(others)) {
    if (other.chip != address.chip || other.line != address.line) continue;
    yaml.reject("line", to_string(address) + " a second time", "a different line for each purpose");
  }
}

}  // namespace

std::vector<LineAddress> lines_of(const GpioConfig& gpio) {
  std::vector<LineAddress> lines;
  if (gpio.trigger) lines.push_back(gpio.trigger->address);
  if (gpio.status_led) lines.push_back(*gpio.status_led);
  if (gpio.fault) lines.push_back(*gpio.fault);
  if (gpio.ignition) lines.push_back(gpio.ignition->address);
  return lines;
}

GpioConfig read_gpio(YamlMap yaml) {
  GpioConfig gpio;
  if (auto trigger = yaml.optional_map("trigger")) gpio.trigger = read_trigger(*trigger);
  if (auto led = yaml.optional_map("status_led")) {
    const LineAddress address = read_address(*led);
    reject_if_taken(*led, address, gpio);
    gpio.status_led = address;
  }
  if (auto fault = yaml.optional_map("fault")) {
    const LineAddress address = read_address(*fault);
    reject_if_taken(*fault, address, gpio);
    gpio.fault = address;
  }
  if (auto line = yaml.optional_map("ignition")) {
    const IgnitionConfig ignition = read_ignition(*line);
    reject_if_taken(*line, ignition.address, gpio);
    gpio.ignition = ignition;
  }
  return gpio;
}

}  // namespace bevloc::firmware
