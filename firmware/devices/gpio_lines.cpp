#include "firmware/devices/gpio_lines.h"

namespace bevloc::firmware {
Result<std::unique_ptr<GpioLines>> GpioLines::open(const GpioConfig& config, drivers::Gpio& gpio,
                                                   Time now) {
  std::unique_ptr<GpioLines> lines(new GpioLines());
  if (config.status_led) {
    auto led = gpio.open_output(*config.status_led, false);
    if (!led) return fail("gpio: {}", led.error().message);
    lines->status_led_ = std::move(*led);
  }
  if (config.ignition) {
    if (Status status = lines->open_ignition(*config.ignition, gpio, now); !status) {
      return tl::unexpected(status.error());
    }
  }
  return lines;
}

Status GpioLines::open_ignition(const IgnitionConfig& config, drivers::Gpio& gpio, Time now) {
  auto line = gpio.open_input(config.address);
  if (!line) return fail("gpio: {}", line.error().message);
  ignition_ = std::move(*line);
  const auto active = ignition_->active();
  if (!active) return fail("gpio: {}", active.error().message);
  ignition_level_.emplace(*active, config.debounce);
  ignition_level_->see(*active, now);
  return {};
}

GpioLines::~GpioLines() {
  if (status_led_) std::ignore = status_led_->set(false);
}

bool GpioLines::step(bool lit, Time now) {
  if (status_led_) {
    if (Status status = status_led_->set(lit); !status) {
      led_errors_.note(status.error(), now);
    }
  }
  const auto on = ignition_on(now);
  if (!on) ignition_errors_.note(on.error(), now);
  return on.value_or(true);
}

Result<bool> GpioLines::ignition_on(Time now) {
  if (!ignition_) return true;
  while (true) {
    const auto edge = ignition_->next_edge(Duration::zero());
    if (!edge) return tl::unexpected(edge.error());
    if (!*edge) break;
    ignition_level_->see((*edge)->active, (*edge)->time);
  }
  // Edges may have been lost, so the current level counts as well.
  const auto active = ignition_->active();
  if (!active) return active;
  ignition_level_->see(*active, now);
  return ignition_level_->settled_at(now);
}

}  // namespace bevloc::firmware
