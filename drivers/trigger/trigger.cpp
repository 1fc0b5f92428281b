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

void Trigger::step(Duration timeout) {
  const Time wait_end = clock_.now() + timeout;
  clock_.sleep_until(std::min(due_, wait_end));
  skip_pulses_before(clock_.now() - lateness_limit_);
  if (clock_.now() < due_) return;
  pulse();
  due_ += config_.period;
}

void Trigger::skip_pulses_before(Time earliest) {
  if (due_ >= earliest) return;
  const auto pulses = (earliest - due_ + config_.period - Duration(1)) / config_.period;
  counters_.skipped += static_cast<uint64_t>(pulses);
  due_ += pulses * config_.period;
}

void Trigger::pulse() {
  const bool risen = line_->set(true).has_value();
  const Time rise = clock_.now();
  clock_.sleep_until(rise + config_.pulse_width);
  const bool fallen = line_->set(false).has_value();
  if (!risen || !fallen) ++counters_.failed;
  if (!risen) return;
  counters_.max_lateness = std::max(counters_.max_lateness.load(), rise - due_);
  pulses_.add(rise);
}

}  // namespace bevloc::drivers
