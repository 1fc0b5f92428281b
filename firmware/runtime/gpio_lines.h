// Drives the appliance's GPIO lines: trigger, status LED and fault; reads ignition.
#pragma once

#include <memory>
#include <thread>

#include "drivers/gpio/debouncer.h"
#include "firmware/config/gpio_config.h"
#include "firmware/runtime/realtime.h"
#include "firmware/runtime/supervisor.h"

namespace bevloc::firmware {

/// Holds the lines from open() to the destructor. The fault line is active until the first step(),
/// in FAULT, while a stage is stalled, and from the destructor on. If the process is killed, most
/// chips keep the last level (docs/drivers.md). A line that fails later is logged once: GPIO must
/// not end localization.
///
/// Thread-bound: called from the supervising thread. Starts one thread, for the trigger.
class GpioLines {
 public:
  /// Fails if a configured line cannot be opened. `realtime` applies to the trigger's thread.
  /// `clock` must be thread-safe. All three must outlive the result.
  static Result<std::unique_ptr<GpioLines>> open(const GpioConfig& config, drivers::Gpio& gpio,
                                                 drivers::Clock& clock, Realtime& realtime);
  ~GpioLines();
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  /// Sets status LED and fault line, and returns whether the ignition is on. To be called about ten
  /// times per second.
  bool step(const ApplianceView& view, Time now);

  /// Ends the trigger's thread; its counters are final then. To be called after capture has ended.
  void stop_trigger();

  /// Null without a trigger line.
  const drivers::Trigger* trigger() const { return trigger_.get(); }

 private:
  GpioLines() = default;
  Status open_all(const GpioConfig& config, drivers::Gpio& gpio, drivers::Clock& clock,
                  Realtime& realtime);
  Status open_ignition(const IgnitionConfig& config, drivers::Gpio& gpio, Time now);
  Status show(bool lit, bool fault);
  Result<bool> ignition_on(Time now);
  void report_once(const Error& error);

  std::unique_ptr<drivers::OutputLine> status_led_;
  std::unique_ptr<drivers::OutputLine> fault_;
  std::unique_ptr<drivers::InputLine> ignition_;
  std::optional<drivers::Debouncer> ignition_level_;
  bool reported_ = false;
  std::unique_ptr<drivers::Trigger> trigger_;
  std::jthread trigger_thread_;  ///< the last member, so that it ends before what it uses is gone
};

}  // namespace bevloc::firmware
