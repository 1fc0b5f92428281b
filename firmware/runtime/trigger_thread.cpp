#include "firmware/runtime/trigger_thread.h"

#include "firmware/devices/line_error_log.h"

namespace bevloc::firmware {
namespace {

/// Longest wait of the thread before it checks whether to end.
constexpr Duration kTriggerPatience = std::chrono::milliseconds(50);

}  // namespace

Result<std::unique_ptr<TriggerThread>> TriggerThread::start(const TriggerLineConfig& config,
                                                            drivers::Gpio& gpio,
                                                            drivers::Clock& clock,
                                                            Realtime& realtime) {
  auto line = gpio.open_output(config.address, false);
  if (!line) return fail("gpio: {}", line.error().message);
  return std::unique_ptr<TriggerThread>(
      new TriggerThread(std::move(*line), config.timing, clock, realtime));
}

TriggerThread::TriggerThread(std::unique_ptr<drivers::OutputLine> line,
                             const drivers::TriggerConfig& timing, drivers::Clock& clock,
                             Realtime& realtime)
    : trigger_(std::move(line), clock, timing),
      thread_([this, &clock, &realtime](std::stop_token stop) {
        realtime.begin_thread(ThreadRole::kCapture, "trigger");
        pulse_until(stop, clock);
        heartbeat_.end();
      }) {}

void TriggerThread::pulse_until(const std::stop_token& stop, const drivers::Clock& clock) {
  LineErrorLog errors("trigger", spdlog::level::err);
  while (!stop.stop_requested()) {
    heartbeat_.beat();
    const Status pulsed = trigger_.step(kTriggerPatience);
    if (!pulsed) errors.note(pulsed.error(), clock.now());
  }
}

void TriggerThread::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

}  // namespace bevloc::firmware
