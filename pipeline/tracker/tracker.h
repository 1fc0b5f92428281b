// The vehicle's pose from wheel odometry, GNSS and corrections from the map.
#pragma once

#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "common/se2.h"
#include "common/time.h"
#include "pipeline/solver/solver.h"
#include "pipeline/tracker/event_history.h"
#include "pipeline/tracker/motion_model.h"

namespace bevloc {

struct OdometrySample {
  Time time;
  double speed_mps = 0.0;       ///< along x, negative when reversing
  double yaw_rate_radps = 0.0;  ///< counter-clockwise
};

struct GnssSample {
  Time time;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< of the rear axle, map frame
  double heading_rad = 0.0;                              ///< counter-clockwise from east
  double position_sigma_m = 0.0;                         ///< per axis
  double heading_sigma_rad = 0.0;
};

struct TrackedPose {
  Time time;
  Se2 map_from_vehicle;
  /// In the vehicle frame: longitudinal m, lateral m, yaw rad. Symmetric positive definite.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double speed_mps = 0.0;       ///< with the wheels' scale corrected
  double yaw_rate_radps = 0.0;  ///< with the sensor's bias removed
};

struct TrackerParameters {
  MotionNoise motion;
  double initial_speed_scale_sigma = 0.02;
  double initial_yaw_rate_bias_sigma_radps = radians(0.3);

  /// Squared Mahalanobis distance beyond which a measured pose is not believed: 99.9 % of honest
  /// ones lie within it (chi square, three degrees of freedom).
  double gate_squared_distance = 16.27;

  /// Times over which errors stay alike. A measurement that follows the last one after dt counts
  /// with its covariance times max(1, correlation time / dt), so that all of them together say
  /// no more than is in them. GNSS: multipath and atmosphere. Corrections: the same piece of map
  /// and the same network, seen again.
  double gnss_correlation_s = 15.0;
  double correction_correlation_s = 0.5;

  double widened_position_sigma_m = 3.0;  ///< what widen() adds
  double widened_yaw_sigma_rad = radians(5.0);

  double history_s = 2.0;          ///< how late a measurement may come
  size_t history_capacity = 1024;  ///< events: odometry, GNSS and corrections in `history_s`
  double max_prediction_s = 0.5;   ///< how long the last odometry sample may stand for the next
  double max_speed_mps = 80.0;     ///< beyond it an odometry sample is absurd
  double max_yaw_rate_radps = 3.0;
  double max_position_m = 1e6;  ///< from the map's origin; beyond it a GNSS sample is absurd
};

/// What became of a measurement.
enum class TrackerUpdate {
  kAccepted,
  kGated,           ///< too far from the estimate to be believed
  kNoEvidence,      ///< the solver had nothing to match
  kTooOld,          ///< before the history
  kOutOfOrder,      ///< odometry not after its last sample
  kNoOdometry,      ///< no odometry sample near enough
  kNotInitialised,  ///< no GNSS sample yet
  kNotFinite,       ///< NaN or infinite values
  kImplausible,     ///< values that cannot be
};
std::string_view name_of(TrackerUpdate update);

/// Error-state extended Kalman filter on SE(2) with the wheels' speed scale error and the yaw rate
/// sensor's bias. Every input counts at its own time: one that comes late is put where it belongs
/// in the history and what follows is computed again. Whatever is refused leaves no trace.
///
/// Without corrections it is the prior that the map is drawn at. Memory is made in the constructor.
/// Not thread safe.
class Tracker {
 public:
  explicit Tracker(const TrackerParameters& parameters = {});

  TrackerUpdate add_odometry(const OdometrySample& sample);

  /// The first one, once there is odometry, sets the pose; later ones update it.
  TrackerUpdate add_gnss(const GnssSample& sample);

  /// The vehicle stood at prior * result.correction when the frame was taken.
  TrackerUpdate add_correction(Time frame_time, const Se2& prior, const Correction& result);

  /// Past poses within the history and near future ones by prediction; nothing before the first
  /// GNSS sample, before the history, or too long after the last odometry.
  std::optional<TrackedPose> pose_at(Time time) const;

  bool is_initialised() const { return !history_.empty(); }

  /// The latest estimate of the wheels' scale error and the sensor's bias; zero before the first.
  double speed_scale_error() const;
  double yaw_rate_bias_radps() const;

  /// Admits that the pose is lost: keeps the estimate, but believes what comes next over it.
  void widen();

  /// Forgets everything.
  void reset();

 private:
  void initialise(const GnssSample& sample);
  TrackerUpdate add_pose(Time time, PoseMeasurement measurement, double correlation_s,
                         std::optional<Time>& last_time);
  bool has_odometry_for(Time time) const;
  MeasuredMotion motion_at(Time time, size_t events_until) const;
  FilterState state_at(Time time, size_t events_until) const;
  void insert(size_t position, const TrackerEvent& event);
  void replay_from(size_t position);
  void drop_old_events();

  TrackerParameters parameters_;
  EventHistory history_;
  std::optional<OdometrySample> last_odometry_;
  std::optional<Time> last_gnss_;
  std::optional<Time> last_correction_;
};

}  // namespace bevloc
