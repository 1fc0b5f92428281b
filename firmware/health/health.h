// The state machine that decides whether the pose is valid, and why not.
#pragma once

#include "common/alert_limits.h"
#include "common/cameras.h"
#include "common/health_state.h"
#include "common/se2.h"
#include "common/time.h"
#include "pipeline/tracker/arbiter.h"
#include "pipeline/tracker/protection_level.h"

namespace bevloc::firmware {

/// Limits of the section `health` of the configuration.
struct HealthLimits {
  Duration odometry_timeout = std::chrono::milliseconds(200);
  Duration gnss_timeout = std::chrono::milliseconds(1500);
  /// Time without a correction that confirms the pose (Seen::confirms()) until DEGRADED.
  Duration correction_timeout = std::chrono::milliseconds(350);
  /// Time without a correction that confirms the pose until LOST.
  Duration lost_timeout = std::chrono::seconds(6);
  /// Number of accepted corrections in a row that must confirm a start (Seen::confirms_start())
  /// before ACQUIRING can change to TRACKING.
  int corrections_to_track = 10;
  /// Number of refused corrections in a row that lead to LOST while the arbiter has not decided
  /// which voter is wrong.
  int refusals_to_lose = 15;
  /// Largest sigmas of a valid pose.
  double longitudinal_sigma_m = 0.70;
  double lateral_sigma_m = 0.30;
  double yaw_sigma_rad = radians(0.75);
  /// The alert limits of a freeway (longitudinal m, lateral m, yaw rad): a larger error is
  /// dangerous. A new pose becomes valid only if its error is well within them. A pose is
  /// lost if its lateral or heading protection level exceeds them and the latest confirming
  /// correction is older than 3 s. The age is compared with 2 s in the first 5 s of a pose. While
  /// match or GNSS is excluded, it is compared with `correction_timeout` if that is shorter.
  Eigen::Vector3d alert_limit = kFreewayAlertLimits;
  /// The parameters of the protection levels that are sent with the pose.
  ProtectionParameters protection;

  bool operator==(const HealthLimits&) const = default;
};

/// The condition of the inputs and of the pose at one moment.
struct HealthInputs {
  bool initialized = false;  ///< the tracker has a pose from GNSS and odometry
  Duration odometry_age = Duration::max();
  Duration gnss_age = Duration::max();
  /// Age of the latest accepted correction that confirms the pose (Seen::confirms()).
  Duration correction_age = Duration::max();
  /// Age of the latest accepted correction.
  Duration match_age = Duration::max();
  CameraMask cameras_present;           ///< cameras that were used in the latest frameset
  bool cameras_unsynchronized = false;  ///< as Synchrony judged the latest frameset
  bool map_nearby = true;               ///< the map has elements around the prior
  bool latest_correction_refused = false;
  Duration valid_age = Duration::max();  ///< time since the pose became valid, while it is valid
  int accepted_in_a_row = 0;
  int refused_in_a_row = 0;
  Verdict verdict;  ///< verdict of the arbiter
  /// OdometryMonitor refused the latest odometry sample, or the odometry on the bus was implausible
  /// within the last second (can::VehicleFaultTimes).
  bool odometry_implausible = false;
  bool foreign_sender = false;     ///< a foreign sender was noticed (can::VehicleFaultTimes)
  bool start_confirmed = true;     ///< matches and GNSS suffice to trust a new pose
  bool clock_gap = false;          ///< time has jumped
  bool calibration_fault = false;  ///< a camera is not where the calibration says
  bool overloaded = false;         ///< framesets were skipped for the latest one
  double longitudinal_sigma_m = 0.0;
  double lateral_sigma_m = 0.0;
  double yaw_sigma_rad = 0.0;
  /// Protection level of the pose: (longitudinal m, lateral m, yaw rad).
  Eigen::Vector3d protection_level = Eigen::Vector3d::Zero();
  bool stamps_contradict = false;  ///< camera stamps and yaw rate disagree (StampWatch)
  bool gnss_lags = false;          ///< GNSS that is not excluded is too old (GnssLagWatch)
  bool network_fault = false;      ///< the network failed its check (VisionStage)
  bool internal_error = false;     ///< the pose or its covariance is not finite
};

/// The transitions are INIT -> ACQUIRING -> TRACKING <-> DEGRADED, TRACKING or DEGRADED -> LOST ->
/// ACQUIRING, and any state -> FAULT, which only a restart ends. The class reads no clock, because
/// the inputs contain all ages. One thread.
class Health {
 public:
  explicit Health(const HealthLimits& limits) : limits_(limits) {}

  /// Makes at most one transition. Returns whether the state changed.
  bool update(const HealthInputs& inputs);

  HealthState state() const { return state_; }
  WhyMask why() const { return why_; }
  /// Whether consumers may use the pose.
  bool pose_valid() const { return claims_pose(state_); }

 private:
  WhyMask find_reasons(const HealthInputs& inputs) const;
  HealthState next_state(const HealthInputs& inputs) const;
  bool is_lost(const HealthInputs& inputs) const;
  bool is_too_uncertain(const HealthInputs& inputs) const;
  bool is_unprotected(const HealthInputs& inputs) const;
  // The conditions that a new pose must meet to become valid.
  bool has_enough_matches(const HealthInputs& inputs) const;
  bool is_within_alert_limits(const HealthInputs& inputs) const;
  bool is_confirmed(const HealthInputs& inputs) const;

  HealthLimits limits_;
  HealthState state_ = HealthState::kInit;
  WhyMask why_ = Why::kNoInitialPose;
};

}  // namespace bevloc::firmware
