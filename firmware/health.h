// The appliance's state, and why it is in it.
#pragma once

#include <string>

#include "can/pose_report.h"
#include "common/time.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::firmware {

using State = can::LocalizerState;

const char* to_string(State state);

/// "camera missing, match rejected"; empty when nothing is wrong.
std::string to_string(can::WhyMask why);

struct HealthLimits {
  Duration odometry_timeout = std::chrono::milliseconds(200);
  Duration gnss_timeout = std::chrono::milliseconds(1500);
  /// Without an accepted correction for this long: DEGRADED.
  Duration correction_timeout = std::chrono::milliseconds(350);
  /// Without one for this long: LOST.
  Duration lost_timeout = std::chrono::seconds(6);
  /// Corrections in a row that must be accepted before ACQUIRING becomes TRACKING.
  int corrections_to_track = 10;
  /// Corrections in a row that are refused before the pose counts as LOST.
  int refusals_to_lose = 15;
  /// 1-sigma limits of a pose that may be sent as valid.
  double longitudinal_sigma_m = 0.60;
  double lateral_sigma_m = 0.30;
  double yaw_sigma_rad = 0.0105;
};

/// What is known about the inputs and the pose at one moment.
struct HealthInputs {
  bool initialized = false;  ///< GNSS and odometry have given a first pose
  Duration odometry_age = Duration::max();
  Duration gnss_age = Duration::max();
  Duration correction_age = Duration::max();  ///< since the latest accepted one
  CameraMask cameras_present;                 ///< of the latest frameset
  bool cameras_unsynchronized = false;        ///< and the motion between them not made up for
  bool map_nearby = true;
  bool latest_correction_refused = false;
  int accepted_in_a_row = 0;
  int refused_in_a_row = 0;
  bool contradicts_gnss = false;  ///< for longer than GNSS noise explains
  bool overloaded = false;        ///< framesets before the latest one were skipped
  double longitudinal_sigma_m = 0.0;
  double lateral_sigma_m = 0.0;
  double yaw_sigma_rad = 0.0;
  bool internal_error = false;
};

/// INIT -> ACQUIRING -> TRACKING <-> DEGRADED; TRACKING, DEGRADED or ACQUIRING -> LOST ->
/// ACQUIRING; any -> FAULT, which needs a person. Pure logic: the caller gives the facts, time
/// included.
class Health {
 public:
  explicit Health(const HealthLimits& limits) : limits_(limits) {}

  /// Takes at most one transition and says whether the state changed.
  bool update(const HealthInputs& inputs);

  State state() const { return state_; }
  can::WhyMask why() const { return why_; }
  /// Whether corrections or GNSS say that the pose is wrong, by more than its own uncertainty.
  bool pose_contradicted() const { return contradicted_; }
  /// Only then may a pose be sent as valid.
  bool pose_valid() const { return state_ == State::kTracking || state_ == State::kDegraded; }

 private:
  can::WhyMask find_reasons(const HealthInputs& inputs) const;
  State next_state(const HealthInputs& inputs) const;
  bool is_lost(const HealthInputs& inputs) const;

  HealthLimits limits_;
  State state_ = State::kInit;
  can::WhyMask why_ = can::Why::kNoInitialPose;
  bool contradicted_ = false;
};

}  // namespace bevloc::firmware
