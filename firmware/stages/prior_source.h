// Gives each frameset its prior: the pose that the tracker predicted for the frameset's time.
#pragma once

#include <optional>

#include "drivers/frameset/frameset.h"
#include "firmware/stages/messages.h"
#include "pipeline/localization/localizer.h"
#include "pipeline/tracker/pose_trail.h"

namespace bevloc::firmware {

/// The prior of one frameset, and the vehicle's motion around its time.
struct Prior {
  Se2 map_from_vehicle;  ///< T0, at the frameset's time
  /// The vehicle's pose at each exposure, in the vehicle frame at the frameset's time. Identity if
  /// motion is not compensated.
  CameraMotions reference_from_exposure{};
  double speed_mps = 0.0;  ///< negative when reversing
  SearchRange range = SearchRange::kAcquiring;
  /// The motion since the frameset of the previous call of at(), if it is known. Framesets that lie
  /// more than 450 ms apart have none.
  std::optional<DrivenStep> driven{};
};

/// Keeps the latest predictions of the estimation stage. Thread-bound: called from the vision
/// thread.
class PriorSource {
 public:
  /// `compensates` says whether to compute the motion between the exposures of a frameset.
  /// `predictions` must outlive this.
  PriorSource(bool compensates, PredictionQueue& predictions)
      : compensates_(compensates), predictions_(predictions) {}

  /// Takes all queued predictions. Does not wait.
  void take_predictions();

  /// Returns the prior, or nothing when no prediction covers the frameset's time, or the motion to
  /// one of its exposures.
  std::optional<Prior> at(const drivers::Frameset& frameset);

 private:
  std::optional<DrivenStep> step_until(Time time);
  std::optional<CameraMotions> motions_in(const drivers::Frameset& frameset) const;

  const bool compensates_;
  PredictionQueue& predictions_;
  PoseTrail trail_;
  bool acquiring_ = true;
  std::optional<Time> previous_time_;  ///< time of the frameset of the previous at()
};

}  // namespace bevloc::firmware
