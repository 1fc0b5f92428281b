// The vision stage: matches the newest frameset with the map and reports the correction.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "drivers/clock/clock.h"
#include "firmware/stages/frameset_source.h"
#include "firmware/stages/messages.h"
#include "firmware/stages/prior_source.h"
#include "firmware/telemetry/cause_log.h"
#include "pipeline/localization/localizer.h"

namespace bevloc::firmware {

/// One localization, for observers such as a recording. It is valid during the call only.
struct VisionSnapshot {
  const drivers::Frameset& frameset;
  const VisionReport& report;
  /// The vehicle's pose at each exposure, in the vehicle frame at the prior (Prior).
  const CameraMotions& reference_from_exposure;
  const SolverResult& solution;
  SearchRange range;
  const HypothesisGrid& hypotheses;     ///< the hypotheses of that range
  std::span<const uint8_t> map_raster;  ///< the map around the prior, kRasterSize bytes
  /// Computes the mask as logits, [3, 400, 200]. To do so, runs the mask branch, which matching
  /// does not need.
  const std::function<std::span<const float>()>& perceived_mask;
};

using VisionObserver = std::function<void(const VisionSnapshot&)>;

struct VisionConfig {
  drivers::SynchronizerConfig synchronizer;
  /// Whether each image is matched from the place where the vehicle was at its exposure.
  bool compensate_motion = true;
  /// Pulses of the trigger, or null without one. They must outlive the stage.
  const drivers::PulseLog* pulses = nullptr;
};

/// Totals since start, readable from any thread.
struct VisionCounters {
  std::atomic<uint64_t> framesets{0};    ///< framesets taken, matched or not
  std::atomic<uint64_t> frames_used{0};  ///< frames in those framesets
  std::atomic<uint64_t> no_prior{0};     ///< framesets whose time no prediction covered
  std::atomic<uint64_t> refused{0};      ///< framesets with fewer usable images than min_cameras
  /// Unreadable images of each camera: of a wrong size, or a JPEG that is damaged or has no colour.
  /// Their frames count as used.
  std::array<std::atomic<uint64_t>, kCameraCount> unreadable{};
  /// The cameras whose images are not used, each a CameraMask (FrozenCameraDetector, ViewMonitor).
  /// There are none while nothing is matched, because then the images are not judged.
  std::atomic<unsigned> frozen{0};
  std::atomic<unsigned> dark{0};
  std::atomic<unsigned> blinded{0};
  std::atomic<unsigned> dirty{0};
  /// The cameras whose time stamps have jumped, a CameraMask.
  std::atomic<unsigned> stamps_jumped{0};
  std::atomic<uint64_t> checks{0};         ///< checks of network and solvers (Localizer::check())
  std::atomic<bool> network_fault{false};  ///< one of them failed; stays true until the restart
  /// Cameras that are not where the calibration says, a CameraMask.
  std::atomic<unsigned> calibration_fault{0};
};

/// Checks network and solvers at construction, and again while the vehicle stands, at most once a
/// minute. After a failed check it matches nothing any more, and every report says so.
///
/// Thread-bound: called from the vision thread. counters() and framesets().counters() are readable
/// from any thread.
class VisionStage {
 public:
  /// Logs a failed check, and a model that cannot be checked. `localizer` and the queues must
  /// outlive the stage.
  VisionStage(Localizer& localizer, const VisionConfig& config, FrameQueue& frames,
              PredictionQueue& predictions, VisionQueue& reports);

  /// Adds an observer, which is called in the vision thread after each match, before its report is
  /// queued. Call it before the first step().
  void observe(VisionObserver observer) { observers_.push_back(std::move(observer)); }

  /// Waits for a frame, at most `timeout`, takes all queued frames and predictions, and matches the
  /// newest frameset. Returns whether there was a frameset.
  bool step(const drivers::Clock& clock, Duration timeout);

  const VisionCounters& counters() const { return counters_; }
  const FramesetSource& framesets() const { return framesets_; }

 private:
  VisionReport report_on(NewestFrameset newest);
  /// Reports faults that are known without a frameset.
  void report_without_frameset(Time now);
  /// Says which cameras deliver frames whose time stamps have jumped, and returns whether these are
  /// most. Two groups of cameras that expose at different times come in turn, each in a frameset of
  /// its own. So the cameras of the frameset before count, too.
  bool most_stamps_jumped(const drivers::Frameset& frameset);
  /// Returns true, at most every 200 ms, while the time stamps of most cameras have jumped so far
  /// that no frameset has their frames.
  bool most_stamps_displaced(Time now);
  /// Matches the frameset, and fills in the parts of the report that depend on the images.
  void match(const drivers::Frameset& frameset, const Prior& prior, VisionReport& report);
  /// Checks network and solvers. Logs why a check failed.
  void check_network();
  void check_network_again(const drivers::Frameset& frameset, const Prior& prior);
  /// Counts the unused images of a frameset, and logs why an image could not be read.
  void note_unused_images(const drivers::Frameset& frameset);
  /// Says of no camera that its image is not used, because nobody has judged the images.
  void forget_unused_images();

  Localizer& localizer_;
  const int min_cameras_;
  FramesetSource framesets_;
  PriorSource priors_;
  VisionQueue& reports_;
  SolverResult solution_;
  std::vector<VisionObserver> observers_;
  const std::function<std::span<const float>()> perceived_mask_;
  VisionCounters counters_;
  std::array<CauseLog, kCameraCount> causes_;  ///< why images could not be read
  /// The cameras whose time stamps jumped: those of the latest two framesets, and those whose
  /// frames are in no frameset (DisplacedFrames).
  CameraMask jumped_;
  CameraMask latest_present_;            ///< cameras of the latest frameset
  bool most_jumped_ = false;             ///< VisionReport::stamps_jumped of the latest report
  uint64_t stamp_jumps_ = 0;             ///< VisionReport::stamp_jumps of the latest report
  Time latest_displaced_ = Time::min();  ///< when displaced frames were reported last
  Time latest_check_ = Time::min();
  std::optional<Time> standing_since_;
};

}  // namespace bevloc::firmware
