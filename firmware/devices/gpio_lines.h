// Drives the status LED and reads the ignition.
#pragma once

#include <memory>

#include "drivers/gpio/debouncer.h"
#include "firmware/config/gpio_config.h"
#include "firmware/devices/line_error_log.h"

namespace bevloc::firmware {

/// Holds the lines from open() to the destructor, which switches the LED off. A line that fails
/// later is logged once per cause, because GPIO must not end localization. The fault line and the
/// trigger have their own files, so that no line waits for another one.
///
/// Thread-bound: called from the supervising thread.
class GpioLines {
 public:
  /// Fails if a configured line cannot be opened. `gpio` must outlive the result.
  static Result<std::unique_ptr<GpioLines>> open(const GpioConfig& config, drivers::Gpio& gpio,
                                                 Time now);
  ~GpioLines();
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  /// Sets the status LED, and returns whether the ignition is on: true without an ignition line and
  /// while it cannot be read. Call it about ten times per second.
  bool step(bool lit, Time now);

 private:
  GpioLines() = default;
  Status open_ignition(const IgnitionConfig& config, drivers::Gpio& gpio, Time now);
  Result<bool> ignition_on(Time now);

  std::unique_ptr<drivers::OutputLine> status_led_;
  std::unique_ptr<drivers::InputLine> ignition_;
  std::optional<drivers::Debouncer> ignition_level_;
  LineErrorLog led_errors_{"status LED", spdlog::level::warn};
  LineErrorLog ignition_errors_{"ignition", spdlog::level::warn};
};

}  // namespace bevloc::firmware
