#include "drivers/trigger/trigger.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace bevloc::drivers {

Trigger::Trigger(std::unique_ptr<OutputLine> line, Clock& clock, const TriggerConfig& config)
    : config_(config),
      lateness_limit_(config.period / 10),
      line_(std::move(line)),
      clock_(clock),
      due_(clock.now() + config.period) {
  assert(config.pulse_width > Duration::zero() && 2 * config.pulse_width < config.period);
}

Status Trigger::step(Duration timeout) {
  const Time wait_end = clock_.now() + timeout;
  clock_.sleep_until(std::min(due_, wait_end));
  skip_pulses_before(clock_.now() - lateness_limit_);
  if (clock_.now() < due_) return {};
  Status given = pulse();
  due_ += config_.period;
  return given;
}

void Trigger::skip_pulses_before(Time earliest) {
  if (due_ >= earliest) return;
  const auto pulses = (earliest - due_ + config_.period - Duration(1)) / config_.period;
  counters_.skipped += static_cast<uint64_t>(pulses);
  due_ += pulses * config_.period;
}

Status Trigger::pulse() {
  Status risen = line_->set(true);
  const Time rise = clock_.now();
  clock_.sleep_until(rise + config_.pulse_width);
  Status fallen = line_->set(false);
  if (!risen || !fallen) ++counters_.failed;
  if (!risen) return risen;
  counters_.max_lateness = std::max(counters_.max_lateness.load(), rise - due_);
  pulses_.add(rise);
  return fallen;
}

}  // namespace bevloc::drivers
