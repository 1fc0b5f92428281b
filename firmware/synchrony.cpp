#include "firmware/synchrony.h"

#include <algorithm>

namespace bevloc::firmware {
namespace {

/// So long without a set, and a report is due that says why.
constexpr Duration kSilence = std::chrono::milliseconds(200);

}  // namespace

bool Synchrony::unsynchronized(const drivers::Frameset& frameset, Time now) {
  told_ = now;
  sets_then_ = synchronizer_.splits().sets();
  note_spread(frameset.spread);
  note_pulse(frameset.time);
  note_drifts();
  return synchronizer_.splits().split() || (!compensates_ && frameset.spread > kSynchronous);
}

bool Synchrony::split_without_sets(Time now) {
  const drivers::SplitMonitor& splits = synchronizer_.splits();
  if (!splits.split() || splits.sets() == sets_then_ || now < told_ + kSilence) return false;
  told_ = now;
  sets_then_ = splits.sets();
  note_drifts();
  return true;
}

void Synchrony::note_spread(Duration spread) {
  counters_.spread = spread;
  counters_.spread_max = std::max(counters_.spread_max.load(), spread);
}

void Synchrony::note_pulse(Time time) {
  if (pulses_ == nullptr) return;
  const auto pulse = pulses_->newest_until(time + kSynchronous);
  if (!pulse || time - *pulse > kSynchronous) ++counters_.off_pulse;
}

void Synchrony::note_drifts() {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto& drift = synchronizer_.rates().drift(camera);
    counters_.drift_ppm[camera] = drift && drift->certain() ? drift->ppm : 0.0;
  }
}

}  // namespace bevloc::firmware
