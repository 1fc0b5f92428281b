// Estimates the vehicle's pose from odometry, GNSS and corrections.
#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "common/se2.h"
#include "common/time.h"
#include "common/vehicle_samples.h"
#include "pipeline/solver/solver_result.h"
#include "pipeline/tracker/event_history.h"
#include "pipeline/tracker/match_repetition.h"
#include "pipeline/tracker/measurements.h"
#include "pipeline/tracker/motion_model.h"
#include "pipeline/tracker/start_heading.h"

namespace bevloc {

struct TrackedPose {
  Time time;
  Se2 map_from_vehicle;
  /// Covariance in the vehicle frame: (longitudinal m, lateral m, yaw rad). Symmetric positive
  /// definite.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double speed_mps = 0.0;       ///< corrected for the estimated scale error of the wheels
  double yaw_rate_radps = 0.0;  ///< corrected for the estimated bias of the yaw rate sensor
};

struct TrackerParameters {
  MotionNoise motion;
  double initial_speed_scale_sigma = 0.02;
  double initial_yaw_rate_bias_sigma_radps = radians(0.3);

  /// Gate: a measured pose with a larger squared Mahalanobis distance is refused. This is the
  /// 99.99 % quantile of the chi-square distribution with three degrees of freedom.
  double gate_squared_distance = 21.1;

  /// Consecutive measurements are not independent: see FilterState and MeasurementModel.
  ErrorCorrelation correlation;
  MeasurementModel measurements;

  double widened_position_sigma_m = 3.0;  ///< added by widen(), per axis
  double widened_yaw_sigma_rad = radians(5.0);

  /// Standard deviations that loosen_odometry() adds. That of the yaw is smaller than
  /// HealthLimits::yaw_sigma_rad, so that a pose with a heading sigma below 0.45 degrees stays
  /// valid.
  double loosened_yaw_rate_bias_sigma_radps = radians(1.0);
  double loosened_yaw_sigma_rad = radians(0.6);

  double history_s = 2.0;  ///< a measurement may arrive this late
  /// The most events (odometry, GNSS, corrections) that the history keeps, even if more of them
  /// come within `history_s`; more than 1.
  size_t history_capacity = 1024;
  /// Prediction beyond the last odometry sample.
  double max_prediction_s = kLongestStandstillStep_s;
  double max_speed_mps = 80.0;  ///< a faster odometry sample is implausible
  double max_yaw_rate_radps = 3.0;
  double max_position_m = 1e6;  ///< per axis, from the map's origin; for GNSS samples

  bool operator==(const TrackerParameters&) const = default;
};

/// What the tracker did with a measurement.
enum class TrackerUpdate {
  kAccepted,
  kGated,           ///< refused by the gate: too far from the estimate
  kNoEvidence,      ///< the solver found nothing to match
  kTooOld,          ///< older than the history
  kOutOfOrder,      ///< odometry that is not newer than the last odometry sample
  kNoOdometry,      ///< the last odometry sample is too old, or there is none
  kNotInitialised,  ///< there is no pose yet, or the measurement is older than the first one
  kNoHeading,       ///< a GNSS position whose heading is not known yet, before the first pose
  kNotFinite,       ///< a value is NaN or infinite
  kImplausible,     ///< a value is beyond its physical limit
};

/// Number of values of TrackerUpdate.
inline constexpr size_t kTrackerUpdates = 10;

/// The name in words, for example "not finite".
std::string_view name_of(TrackerUpdate update);

/// What to do with a measured pose.
enum class Trust : uint8_t {
  kUse,      ///< update the estimate if the gate accepts it
  kExamine,  ///< only compare it with the estimate, as the gate does
};

/// Error-state extended Kalman filter on SE(2). It also estimates the scale error of the wheel
/// speed, the bias of the yaw rate sensor and the correlated errors of matches and GNSS. Each
/// measurement applies at its own time: a late one is inserted into the history, and the later
/// states are computed again. A refused measurement changes nothing.
///
/// The error of the matches can change from one frame to the next, for example where another line
/// comes into view. The gate then refuses the matches, because the filter expects the earlier error
/// again. The third refused match in a row is accepted if it passes the gate without this
/// expectation.
///
/// Matches that repeat what earlier ones said count less: see MatchRepetition.
///
/// Allocates in the constructor only. One thread.
class Tracker {
 public:
  explicit Tracker(const TrackerParameters& parameters = {});

  /// Calls add_odometry() or add_gnss().
  TrackerUpdate add(const VehicleSample& sample);

  TrackerUpdate add_odometry(const OdometrySample& sample);

  /// The reason for which add_odometry() would refuse this sample, or nothing if it would accept
  /// it.
  std::optional<TrackerUpdate> refusal_of(const OdometrySample& sample) const;

  /// The first sample after odometry initialises the pose; later ones update it. If its yaw is
  /// unknown or uncertain, the pose waits until the way between two positions tells the heading
  /// (StartHeading).
  TrackerUpdate add_gnss(const GnssSample& sample, Trust trust = Trust::kUse);

  /// Adds a result of the solver: at `frame_time` the vehicle was at prior * result.correction.
  TrackerUpdate add_correction(Time frame_time, const Se2& prior, const MatchResult& result,
                               Trust trust = Trust::kUse);

  /// The pose at any time within the history, or predicted up to `max_prediction_s` past the last
  /// odometry sample. Returns nothing outside that range or before the first pose.
  std::optional<TrackedPose> pose_at(Time time) const;

  const TrackerParameters& parameters() const { return parameters_; }
  bool is_initialised() const { return !history_.empty(); }

  /// The innovation of the latest GNSS sample or correction that reached the gate, refused or not.
  const PoseInnovation& latest_innovation() const { return latest_innovation_; }

  /// The correlated error of GNSS at the latest event. A large value means that GNSS contradicts
  /// the pose. It is zero before the first pose.
  GnssError gnss_error() const;

  /// The latest estimates of the scale error and of the bias. They are zero before the first pose.
  double speed_scale_error() const;
  double yaw_rate_bias_radps() const;

  /// Raises the covariance of a pose that turned out to be wrong. Keeps the estimate, but the next
  /// measurements pass the gate and outweigh it.
  void widen();

  /// Raises the uncertainty of the scale error, of the yaw rate bias and of the yaw, because dead
  /// reckoning drifts: the next measurements correct them.
  void loosen_odometry();

  /// Forgets the pose. GNSS sets it again as at the start (add_gnss()).
  void restart();

  /// Returns to the state after construction.
  void reset();

 private:
  PoseMeasurement measurement_of(const GnssPose& gnss) const;
  TrackerUpdate initialise(Time time, GnssPose gnss);
  TrackerUpdate add_pose(Time time, PoseMeasurement measurement, Trust trust);
  /// Whether the gate accepts `measurement`. Sets latest_innovation(), and `has_new_error` of a
  /// match that is accepted without the expected match error.
  bool passes_gate(FilterState state, Trust trust, PoseMeasurement& measurement);
  bool has_odometry_for(Time time) const;
  MeasuredMotion motion_at(Time time, size_t events_until) const;
  FilterState state_at(Time time, size_t events_until) const;
  /// Where an event of this time belongs in the history; 0 if it is too old for it.
  size_t position_of(Time time) const;
  /// Inserts `event` before the event at `position` and updates the states from there. The position
  /// must be one of position_of().
  void insert(size_t position, const TrackerEvent& event);
  /// Appends an event of this kind at the time of the latest one, if there is a pose. The next
  /// match then counts in full.
  void append_now(TrackerEvent::Kind kind);
  void replay_from(size_t position);
  void drop_old_events();

  TrackerParameters parameters_;
  EventHistory history_;
  Time begun_;  ///< time of the first pose since the start or restart
  std::optional<OdometrySample> last_odometry_;
  PoseInnovation latest_innovation_;
  int refused_matches_ = 0;  ///< number in a row, up to the latest match
  MatchRepetition repetition_;
  StartHeading start_heading_;
};

}  // namespace bevloc
