#include "drivers/trigger/trigger.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace bevloc::drivers {

Trigger::Trigger(std::unique_ptr<OutputLine> line, Clock& clock, const TriggerConfig& config)
    : config_(config),
      most_late_(config.period / 10),
      line_(std::move(line)),
      clock_(clock),
      beat_(clock.now() + config.period) {
  assert(config.pulse_width > Duration::zero() && 2 * config.pulse_width < config.period);
}

void Trigger::step(Duration patience) {
  const Time wait_end = clock_.now() + patience;
  clock_.sleep_until(std::min(beat_, wait_end));
  skip_beats_before(clock_.now() - most_late_);
  if (clock_.now() < beat_) return;
  pulse();
  beat_ += config_.period;
}

void Trigger::skip_beats_before(Time earliest) {
  if (beat_ >= earliest) return;
  const auto beats = (earliest - beat_ + config_.period - Duration(1)) / config_.period;
  counters_.skipped += static_cast<uint64_t>(beats);
  beat_ += beats * config_.period;
}

void Trigger::pulse() {
  const bool given = line_->set(true).has_value();
  const Time rise = clock_.now();
  clock_.sleep_until(rise + config_.pulse_width);
  const bool ended = line_->set(false).has_value();
  if (!given || !ended) ++counters_.failed;
  if (!given) return;
  counters_.latest_by = std::max(counters_.latest_by.load(), rise - beat_);
  pulses_.add(rise);
}

}  // namespace bevloc::drivers
