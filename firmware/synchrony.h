// How well the cameras keep together.
#pragma once

#include <array>
#include <atomic>

#include "drivers/frameset/synchronizer.h"
#include "drivers/trigger/pulse_log.h"

namespace bevloc::firmware {

/// Readable from any thread.
struct SynchronyCounters {
  std::atomic<Duration> spread{};      ///< of the latest set: its latest frame from its time
  std::atomic<Duration> spread_max{};  ///< of all sets since start
  std::atomic<uint64_t> off_pulse{0};  ///< sets that no trigger pulse explains
  /// By how much each camera is faster than the median camera; 0 unless that is certain.
  std::array<std::atomic<double>, kCameraCount> drift_ppm{};
};

/// Watches the synchronizer's sets. Thread: the vision thread; counters() from any.
class Synchrony {
 public:
  /// Frames of one set that are further apart show different places: 10 cm at 20 m/s. Frames
  /// further from their trigger pulse did not answer it.
  static constexpr Duration kSynchronous = std::chrono::milliseconds(5);

  /// `compensates`: whether the motion between the frames of a set is made up for. `pulses`: null
  /// without a trigger; else it must outlive this, as must the synchronizer.
  Synchrony(const drivers::FramesetSynchronizer& synchronizer, bool compensates,
            const drivers::PulseLog* pulses)
      : synchronizer_(synchronizer), compensates_(compensates), pulses_(pulses) {}

  /// Notes a set that was given out. True when its frames, or those of the sets before, do not
  /// belong together.
  bool unsynchronized(const drivers::Frameset& frameset, Time now);

  /// True when no set is given out any more because the cameras are out of step and none has enough
  /// of them: now and then, for a report in the place of theirs.
  bool split_without_sets(Time now);

  const SynchronyCounters& counters() const { return counters_; }

 private:
  void note_spread(Duration spread);
  void note_pulse(Time time);
  void note_drifts();

  const drivers::FramesetSynchronizer& synchronizer_;
  const bool compensates_;
  const drivers::PulseLog* pulses_;
  Time told_ = Time::min();  ///< when it was last asked to judge, or said so by itself
  uint64_t sets_then_ = 0;
  SynchronyCounters counters_;
};

}  // namespace bevloc::firmware
