// Frames in, corrections of the pose out: the stage that sees.
#pragma once

#include <array>
#include <atomic>
#include <functional>

#include "drivers/clock/clock.h"
#include "drivers/frameset/synchronizer.h"
#include "firmware/messages.h"
#include "firmware/pose_trail.h"
#include "firmware/synchrony.h"
#include "pipeline/localization/localizer.h"

namespace bevloc::firmware {

/// A whole localization, as an observer (recording, demo) may look at it while it lasts.
struct VisionSnapshot {
  const drivers::Frameset& frameset;
  const VisionReport& report;
  const SolverResult& solution;
  SearchRange range;
  Localizer& localizer;
};

struct VisionConfig {
  drivers::SynchronizerConfig synchronizer;
  /// Whether each camera is taken from where the vehicle was when it exposed.
  bool compensate_motion = true;
  /// Of the trigger; null without one. Must outlive the stage.
  const drivers::PulseLog* pulses = nullptr;
};

/// Totals since start; readable from any thread.
struct VisionCounters {
  std::atomic<uint64_t> steps{0};      ///< the thread's own heartbeat
  std::atomic<uint64_t> framesets{0};  ///< localized
  std::atomic<uint64_t> frames_used{0};
  std::atomic<uint64_t> framesets_skipped{0};  ///< a newer one was already there
  std::atomic<uint64_t> frames_skipped{0};     ///< of those
  std::atomic<uint64_t> no_prior{0};           ///< framesets at whose times no prediction was known
  std::atomic<uint64_t> refused{0};            ///< framesets with too few readable pictures
  /// Of each camera, pictures of the wrong size and damaged JPEGs; the frames count as used.
  std::array<std::atomic<uint64_t>, kCameraCount> unreadable{};
  std::atomic<unsigned> frozen{0};  ///< bit mask: cameras that are left out, their picture stands
};

/// Thread: one, the vision thread; counters() from any.
class VisionStage {
 public:
  VisionStage(Localizer& localizer, const VisionConfig& config, FrameQueue& frames,
              PredictionQueue& predictions, VisionQueue& reports);

  /// Called with every localization, in the vision thread, before its report is handed on.
  void observe(std::function<void(const VisionSnapshot&)> observer);

  /// Waits for a frame, `timeout` at most, takes in all that has arrived, and localizes the newest
  /// complete frameset, if there is one. Says whether it did.
  bool step(const drivers::Clock& clock, Duration timeout);

  const VisionCounters& counters() const { return counters_; }
  const drivers::FramesetSynchronizer& synchronizer() const { return synchronizer_; }
  const SynchronyCounters& synchrony() const { return synchrony_.counters(); }

 private:
  void take_in(const drivers::Clock& clock, Duration timeout);
  std::optional<drivers::Frameset> newest_frameset(Time now);
  VisionReport report_on(const drivers::Frameset& frameset, Time now, bool skipped);
  void localize(const drivers::Frameset& frameset, VisionReport report);
  /// Fills in what only the pictures tell.
  void match(const drivers::Frameset& frameset, const CameraMotions& motions, VisionReport& report);
  void count_left_out(CameraMask given, CameraMask used);
  /// Nothing when the motion to one of its frames is not known.
  std::optional<CameraMotions> motions_in(const drivers::Frameset& frameset) const;

  Localizer& localizer_;
  const int min_cameras_;
  const bool compensate_motion_;
  drivers::FramesetSynchronizer synchronizer_;
  Synchrony synchrony_;
  FrameQueue& frames_;
  PredictionQueue& predictions_;
  VisionQueue& reports_;
  PoseTrail trail_;
  bool acquiring_ = true;
  SolverResult solution_;
  std::function<void(const VisionSnapshot&)> observer_;
  VisionCounters counters_;
};

}  // namespace bevloc::firmware
