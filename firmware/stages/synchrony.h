// Judges from the framesets whether the cameras expose together.
#pragma once

#include <array>
#include <atomic>

#include "drivers/frameset/synchronizer.h"
#include "drivers/trigger/pulse_log.h"

namespace bevloc::firmware {

/// What Synchrony found out, readable from any thread.
struct SynchronyCounters {
  std::atomic<Duration> spread{};      ///< spread of the latest frameset
  std::atomic<Duration> spread_max{};  ///< largest spread since start
  std::atomic<uint64_t> off_pulse{0};  ///< framesets without a trigger pulse at their time
  /// Drift of each camera against the median camera, or 0 while none is certain.
  std::array<std::atomic<double>, kCameraCount> drift_ppm{};
};

/// Watches the framesets that a synchronizer emits. Thread-bound: called from the vision thread.
/// counters() is readable from any thread.
class Synchrony {
 public:
  /// The largest spread of synchronized cameras: in 5 ms a vehicle at 20 m/s moves 10 cm. This is
  /// also the largest time from a trigger pulse to the frameset that it caused.
  static constexpr Duration kSynchronous = std::chrono::milliseconds(5);

  /// `compensates` says whether the matching corrects for the motion between the frames of a
  /// frameset. `pulses` is null without a trigger. `synchronizer` and `pulses` must outlive this.
  Synchrony(const drivers::FramesetSynchronizer& synchronizer, bool compensates,
            const drivers::PulseLog* pulses)
      : synchronizer_(synchronizer), compensates_(compensates), pulses_(pulses) {}

  /// Counts an emitted frameset. Returns true when the cameras do not expose together, or when the
  /// frameset's spread exceeds kSynchronous and motion is not compensated.
  bool unsynchronized(const drivers::Frameset& frameset, Time now);

  /// Returns true, at most every 200 ms, while unsynchronized cameras keep any frameset from being
  /// emitted, because each frameset has fewer cameras than the minimum.
  bool unsynchronized_without_framesets(Time now);

  const SynchronyCounters& counters() const { return counters_; }

 private:
  void judged(Time now);
  void note_spread(Duration spread);
  void note_pulse(Time time);
  void note_drifts();

  const drivers::FramesetSynchronizer& synchronizer_;
  const bool compensates_;
  const drivers::PulseLog* pulses_;
  Time last_judgement_ = Time::min();
  /// Framesets that were formed by then, emitted or not.
  uint64_t framesets_at_last_judgement_ = 0;
  SynchronyCounters counters_;
};

}  // namespace bevloc::firmware
