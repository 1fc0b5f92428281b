// Generates the pulses that trigger the exposure of the cameras (FSYNC).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "drivers/clock/clock.h"
#include "drivers/gpio/gpio.h"
#include "drivers/trigger/pulse_log.h"

namespace bevloc::drivers {

struct TriggerConfig {
  Duration period = std::chrono::milliseconds(100);
  /// How long the line is active, which is less than half a period.
  Duration pulse_width = std::chrono::milliseconds(1);
};

/// Totals since construction, readable from any thread.
struct TriggerCounters {
  std::atomic<uint64_t> skipped{0};      ///< pulses that were omitted because they were too late
  std::atomic<uint64_t> failed{0};       ///< pulses that the line refused
  std::atomic<Duration> max_lateness{};  ///< maximum lateness of a pulse
};

/// Pulse k is due at start + k periods, so a late pulse does not delay those after it. A pulse that
/// would be more than a tenth of a period late is omitted. So two pulses are never closer than nine
/// tenths of a period: cameras that still read out the previous frame would miss the second pulse.
///
/// Thread-bound: step() is called from the trigger thread. The rest is readable from any thread.
class Trigger {
 public:
  /// The first pulse is due one period from now. `clock` must outlive the trigger.
  Trigger(std::unique_ptr<OutputLine> line, Clock& clock, const TriggerConfig& config);

  /// Waits up to `timeout` until the next pulse is due, and gives it. Fails if the line refuses the
  /// pulse. The next call then continues with the following pulse.
  Status step(Duration timeout);

  const PulseLog& pulses() const { return pulses_; }
  const TriggerCounters& counters() const { return counters_; }

 private:
  void skip_pulses_before(Time earliest);
  Status pulse();

  const TriggerConfig config_;
  const Duration lateness_limit_;
  std::unique_ptr<OutputLine> line_;
  Clock& clock_;
  Time due_;  ///< due time of the next pulse
  PulseLog pulses_;
  TriggerCounters counters_;
};

}  // namespace bevloc::drivers
