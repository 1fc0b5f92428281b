// The thread that pulses the trigger line.
#pragma once

#include <memory>
#include <thread>

#include "drivers/trigger/trigger.h"
#include "firmware/config/gpio_config.h"
#include "firmware/threads/heartbeat.h"
#include "firmware/threads/realtime.h"

namespace bevloc::firmware {

/// Pulses the line from start() to stop() or the destructor. One thread.
class TriggerThread {
 public:
  /// Starts the thread. Fails if the line cannot be opened. `realtime` applies to the thread.
  /// `clock` must be thread-safe. `gpio`, `clock` and `realtime` must outlive the result.
  static Result<std::unique_ptr<TriggerThread>> start(const TriggerLineConfig& config,
                                                      drivers::Gpio& gpio, drivers::Clock& clock,
                                                      Realtime& realtime);

  /// Ends the thread, after which its counters are final. Call it after capture has ended.
  void stop();

  const drivers::Trigger& trigger() const { return trigger_; }
  const Heartbeat& heartbeat() const { return heartbeat_; }

 private:
  TriggerThread(std::unique_ptr<drivers::OutputLine> line, const drivers::TriggerConfig& timing,
                drivers::Clock& clock, Realtime& realtime);
  void pulse_until(const std::stop_token& stop, const drivers::Clock& clock);

  drivers::Trigger trigger_;
  Heartbeat heartbeat_;
  std::jthread thread_;  ///< the last member, so that it ends before what it uses is gone
};

}  // namespace bevloc::firmware
