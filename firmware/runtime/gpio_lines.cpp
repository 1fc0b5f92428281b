#include "firmware/runtime/gpio_lines.h"

#include <spdlog/spdlog.h>

#include "firmware/runtime/status_led.h"

namespace bevloc::firmware {
namespace {

/// Longest wait of the trigger's thread before it checks whether to end.
constexpr Duration kTriggerPatience = std::chrono::milliseconds(50);

/// Stores an opened line in `line`, or returns why it could not be opened.
template <typename Line, typename Opened>
Status take(Opened opened, std::unique_ptr<Line>& line) {
  if (!opened) return fail("gpio: {}", opened.error().message);
  line = std::move(*opened);
  return {};
}

}  // namespace

Result<std::unique_ptr<GpioLines>> GpioLines::open(const GpioConfig& config, drivers::Gpio& gpio,
                                                   drivers::Clock& clock, Realtime& realtime) {
  std::unique_ptr<GpioLines> lines(new GpioLines());
  if (Status status = lines->open_all(config, gpio, clock, realtime); !status) {
    return tl::unexpected(status.error());
  }
  return lines;
}

Status GpioLines::open_all(const GpioConfig& config, drivers::Gpio& gpio, drivers::Clock& clock,
                           Realtime& realtime) {
  if (config.fault) {
    if (Status s = take(gpio.open_output(*config.fault, true), fault_); !s) return s;
  }
  if (config.status_led) {
    if (Status s = take(gpio.open_output(*config.status_led, false), status_led_); !s) return s;
  }
  if (config.ignition) {
    if (Status s = open_ignition(*config.ignition, gpio, clock.now()); !s) return s;
  }
  if (!config.trigger) return {};
  std::unique_ptr<drivers::OutputLine> line;
  if (Status s = take(gpio.open_output(config.trigger->address, false), line); !s) return s;
  trigger_ = std::make_unique<drivers::Trigger>(std::move(line), clock, config.trigger->timing);
  trigger_thread_ = std::jthread([&realtime, trigger = trigger_.get()](std::stop_token stop) {
    realtime.begin_thread(ThreadRole::kCapture, "trigger");
    while (!stop.stop_requested()) trigger->step(kTriggerPatience);
  });
  return {};
}

/// Ignition counts as on until it has been off for the debounce time, also at the start.
Status GpioLines::open_ignition(const IgnitionConfig& config, drivers::Gpio& gpio, Time now) {
  if (Status s = take(gpio.open_input(config.address), ignition_); !s) return s;
  const auto active = ignition_->active();
  if (!active) return fail("gpio: {}", active.error().message);
  ignition_level_.emplace(true, config.debounce);
  ignition_level_->see(*active, now);
  return {};
}

GpioLines::~GpioLines() {
  if (Status status = show(false, true); !status) report_once(status.error());
}

void GpioLines::stop_trigger() {
  if (!trigger_thread_.joinable()) return;
  trigger_thread_.request_stop();
  trigger_thread_.join();
}

bool GpioLines::step(const ApplianceView& view, Time now) {
  const bool fault = view.state == HealthState::kFault || view.stalled;
  if (Status status = show(is_lit(view.state, now), fault); !status) report_once(status.error());
  const auto on = ignition_on(now);
  if (!on) report_once(on.error());
  return on.value_or(true);
}

Status GpioLines::show(bool lit, bool fault) {
  if (status_led_) {
    if (Status status = status_led_->set(lit); !status) return status;
  }
  return fault_ ? fault_->set(fault) : Status();
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

void GpioLines::report_once(const Error& error) {
  if (!reported_) {
    spdlog::warn("gpio: {}; check the chip, then restart bevlocd", error.message);
  }
  reported_ = true;
}

}  // namespace bevloc::firmware
