// Decides what the bus tells about the clock.
#pragma once

#include "can/messages/pose_report.h"
#include "drivers/clock/clock_discipline.h"
#include "firmware/config/clock_config.h"

namespace bevloc::firmware {

/// Reports the configured source while the kernel says that a service keeps the system clock and
/// that its error is within the configured bound. Otherwise reports a free-running clock.
/// Thread-bound: called from the supervising thread.
class ClockWatch {
 public:
  /// The times of both clocks at one moment.
  struct Reading {
    drivers::WallTime wall;
    Time steady{};
  };
  using Read = Reading (*)();

  explicit ClockWatch(const ClockConfig& config, Read read = read_clocks)
      : config_(config), read_(read) {}

  /// Asks the kernel. Logs each change, and what to do.
  can::ClockReport step();

 private:
  static Reading read_clocks();
  void log_loss(const drivers::ClockDiscipline& discipline) const;

  const ClockConfig config_;
  const Read read_;
  bool good_ = false;
  bool loss_logged_ = false;
};

}  // namespace bevloc::firmware
