#include "firmware/stages/synchrony.h"

#include <algorithm>

namespace bevloc::firmware {
namespace {

/// Shortest time between two judgements while no frameset is emitted.
constexpr Duration kSilence = std::chrono::milliseconds(200);

}  // namespace

bool Synchrony::unsynchronized(const drivers::Frameset& frameset, Time now) {
  judged(now);
  note_spread(frameset.spread);
  note_pulse(frameset.time);
  note_drifts();
  return synchronizer_.splits().split() || (!compensates_ && frameset.spread > kSynchronous);
}

bool Synchrony::unsynchronized_without_framesets(Time now) {
  const drivers::SplitMonitor& splits = synchronizer_.splits();
  const bool none_formed = splits.sets() == framesets_at_last_judgement_;
  if (!splits.split() || none_formed || now < last_judgement_ + kSilence) return false;
  judged(now);
  note_drifts();
  return true;
}

void Synchrony::judged(Time now) {
  last_judgement_ = now;
  framesets_at_last_judgement_ = synchronizer_.splits().sets();
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
