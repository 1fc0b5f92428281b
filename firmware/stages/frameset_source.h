// Forms framesets from the frames of the capture stages, and emits the newest.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "common/published.h"
#include "drivers/clock/clock.h"
#include "drivers/frameset/synchronizer.h"
#include "firmware/stages/messages.h"
#include "firmware/stages/synchrony.h"

namespace bevloc::firmware {

/// Totals since start, readable from any thread.
struct FramesetCounters {
  std::atomic<uint64_t> skipped{0};         ///< framesets dropped because a newer one was ready
  std::atomic<uint64_t> frames_skipped{0};  ///< frames in those framesets
  std::atomic<uint64_t> clock_gaps{0};      ///< see FramesetSource::kGap
};

/// The newest frameset that was ready.
struct NewestFrameset {
  drivers::Frameset frameset;
  bool skipped = false;         ///< older framesets were skipped for this one
  bool unsynchronized = false;  ///< the cameras do not expose together (Synchrony)
};

/// The cameras whose latest frame is in no frameset because its time stamp jumped: it lies in the
/// future, or before the camera's earlier frames.
struct DisplacedFrames {
  CameraMask cameras;
  uint64_t stamp_jumps = 0;  ///< the largest drivers::Frame::stamp_jumps of their frames
};

/// Owns the synchronizer. Thread-bound: called from the vision thread. counters(), synchrony() and
/// frames_of() are readable from any thread.
class FramesetSource {
 public:
  /// If the thread hung for longer than this between two looks at the clock, or the machine was
  /// suspended (ClockGapDetector::kSuspension), the earlier frames are forgotten, because the
  /// vehicle may be elsewhere.
  static constexpr Duration kGap = std::chrono::seconds(1);

  /// `compensates` says whether the matching corrects for the motion between the frames of a
  /// frameset. `pulses` are those of the trigger, or null without one. `frames` and `pulses` must
  /// outlive this.
  FramesetSource(const drivers::SynchronizerConfig& config, bool compensates,
                 const drivers::PulseLog* pulses, FrameQueue& frames);
  FramesetSource(const FramesetSource&) = delete;
  FramesetSource& operator=(const FramesetSource&) = delete;

  /// Waits for a frame, at most `timeout`, then takes all queued frames. Returns earlier when a
  /// frameset has waited long enough for its missing cameras.
  void take_frames(const drivers::Clock& clock, Duration timeout);

  /// Returns the newest frameset that is ready at `now`, or nothing if there is none. Skips and
  /// counts older ones.
  std::optional<NewestFrameset> newest(Time now);

  /// Returns true, at most every 200 ms, while unsynchronized cameras keep any frameset from being
  /// emitted.
  bool unsynchronized_without_framesets(Time now) {
    return synchrony_.unsynchronized_without_framesets(now);
  }

  const DisplacedFrames& displaced() const { return displaced_; }

  const FramesetCounters& counters() const { return counters_; }
  const SynchronyCounters& synchrony() const { return synchrony_.counters(); }
  /// Returns what became of the frames of one camera.
  drivers::SynchronizerCounters frames_of(int camera) const { return frames_of_[camera].load(); }

 private:
  void look_at_clock(const drivers::Clock& clock);
  void add(drivers::Frame frame, Time now);
  std::optional<NewestFrameset> poll(Time now);

  drivers::FramesetSynchronizer synchronizer_;
  Synchrony synchrony_;
  FrameQueue& frames_;
  DisplacedFrames displaced_;
  FramesetCounters counters_;
  std::optional<Time> latest_look_;
  Duration suspended_{};  ///< Clock::suspended() at the latest look
  std::array<Published<drivers::SynchronizerCounters>, kCameraCount> frames_of_;
};

}  // namespace bevloc::firmware
