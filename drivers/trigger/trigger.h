// Pulses that tell the cameras to expose (FSYNC).
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
  /// How long the line is active; less than half a period.
  Duration pulse_width = std::chrono::milliseconds(1);
};

/// Totals since start; readable from any thread.
struct TriggerCounters {
  std::atomic<uint64_t> skipped{0};  ///< beats without a pulse, because it would have come too late
  std::atomic<uint64_t> failed{0};   ///< pulses that the line refused
  std::atomic<Duration> latest_by{};  ///< how late the latest given pulse of all was
};

/// Gives a pulse on every beat of the clock: beat k is at start + k periods, so a late pulse does
/// not move those after it. One that would come more than a tenth of a period late is left out, so
/// that two are never closer than nine tenths: cameras that are still reading out would lose the
/// second.
///
/// Threads: step() belongs to one thread, best one of its own; the rest is for any.
class Trigger {
 public:
  /// The first beat is one period from now.
  Trigger(std::unique_ptr<OutputLine> line, Clock& clock, const TriggerConfig& config);

  /// Waits for the next beat, `patience` at most, and gives its pulse.
  void step(Duration patience);

  const PulseLog& pulses() const { return pulses_; }
  const TriggerCounters& counters() const { return counters_; }

 private:
  void skip_beats_before(Time earliest);
  void pulse();

  const TriggerConfig config_;
  const Duration most_late_;
  std::unique_ptr<OutputLine> line_;
  Clock& clock_;
  Time beat_;
  PulseLog pulses_;
  TriggerCounters counters_;
};

}  // namespace bevloc::drivers
