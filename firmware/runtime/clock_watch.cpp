#include "firmware/runtime/clock_watch.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "common/kernel_time.h"

namespace bevloc::firmware {

ClockWatch::Reading ClockWatch::read_clocks() {
  const ClockPair clocks = read_with_steady(CLOCK_REALTIME);
  Reading reading{{clocks.clock, drivers::read_clock_discipline()}, clocks.steady};
  reading.wall.discipline.max_error += clocks.error;
  return reading;
}

can::ClockReport ClockWatch::step() {
  if (config_.source == can::TimeSource::kFreeRunning) return {};
  const Reading reading = read_();
  const drivers::ClockDiscipline& discipline = reading.wall.discipline;
  const bool good = discipline.synchronized && discipline.max_error <= config_.max_error;
  const bool was_good = std::exchange(good_, good);
  if (!good) {
    const bool was_logged = std::exchange(loss_logged_, true);
    if (was_good || !was_logged) log_loss(discipline);
    return {};
  }
  if (!was_good) {
    spdlog::info("clock: synchronized, error at most {:.3f} ms",
                 to_milliseconds(discipline.max_error));
  }
  return {.source = config_.source,
          .utc_offset = reading.wall.since_1970 - reading.steady.time_since_epoch(),
          .utc_error = discipline.max_error};
}

void ClockWatch::log_loss(const drivers::ClockDiscipline& discipline) const {
  if (discipline.synchronized) {
    spdlog::warn(
        "clock: found an error of up to {:.3f} ms, wanted {:.3f} ms (clock.max_error_ms); "
        "TimeSource is FREE_RUNNING; check chrony or phc2sys",
        to_milliseconds(discipline.max_error), to_milliseconds(config_.max_error));
  } else {
    spdlog::warn(
        "clock: found a system clock that the kernel calls not synchronized, wanted one that a "
        "time service keeps (clock.source); TimeSource is FREE_RUNNING; check chrony or phc2sys, "
        "and that the drop-in clock.conf is installed");
  }
}

}  // namespace bevloc::firmware
