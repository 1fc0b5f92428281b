// The appliance's GPIO lines: trigger, status LED, fault and ignition.
#pragma once

#include <memory>
#include <thread>

#include "drivers/gpio/debouncer.h"
#include "firmware/gpio_config.h"
#include "firmware/realtime.h"
#include "firmware/supervisor.h"

namespace bevloc::firmware {

/// From open() to the destructor. The fault line is active from the start until the stages run, in
/// FAULT, while a stage hangs, and from the end on; if the process is killed nobody can set it, and
/// most chips keep its last level (docs/drivers.md). A line that fails later is reported once and
/// left: GPIO must not end localization.
///
/// Threads: the trigger's own, made here; all else belongs to the supervising one.
class GpioLines {
 public:
  /// Fails where a configured line cannot be opened. `clock` must be thread safe; it, `gpio` and
  /// `realtime`, which holds for the trigger's thread, must outlive this.
  static Result<std::unique_ptr<GpioLines>> open(const GpioConfig& config, drivers::Gpio& gpio,
                                                 drivers::Clock& clock, Realtime& realtime);
  ~GpioLines();
  GpioLines(const GpioLines&) = delete;
  GpioLines& operator=(const GpioLines&) = delete;

  /// Shows how the appliance is, and says whether ignition is on. To be called about ten times a
  /// second.
  bool step(const ApplianceView& view, Time now);

  /// When nobody takes pictures any more: the counts of the trigger are final then.
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
  std::jthread trigger_thread_;  ///< the last member: ends before what it uses
};

}  // namespace bevloc::firmware
