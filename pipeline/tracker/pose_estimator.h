// Estimates the pose from three voters (match, GNSS, dead reckoning) and says which one is wrong.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "common/time.h"
#include "common/vehicle_samples.h"
#include "pipeline/tracker/arbiter.h"
#include "pipeline/tracker/evidence.h"
#include "pipeline/tracker/gnss_scatter.h"
#include "pipeline/tracker/map_offset_monitor.h"
#include "pipeline/tracker/odometry_monitor.h"
#include "pipeline/tracker/protection_level.h"
#include "pipeline/tracker/start_confirmation.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc {

/// The tracker with its arbiter: excludes the voter that contradicts the two others, and starts
/// again where nothing can be trusted. Allocates in the constructor only. One thread.
class PoseEstimator {
 public:
  explicit PoseEstimator(const TrackerParameters& parameters)
      : tracker_(parameters),
        arbiter_(parameters.correlation.gnss_s),
        map_offset_(parameters.correlation.gnss_s),
        gnss_scatter_(parameters.measurements, parameters.correlation.gnss_s) {}

  /// Adds a sample of the vehicle. A sample of an excluded voter changes nothing.
  TrackerUpdate add(const VehicleSample& sample);

  /// The outcome of a match.
  struct MatchOutcome {
    TrackerUpdate update = TrackerUpdate::kNoEvidence;
    Seen seen;
  };

  /// Adds a result of the solver, as Tracker::add_correction() does. Returns kGated also while
  /// matches are excluded, and kNoEvidence also if the mean score says that this is another place.
  MatchOutcome add_match(Time frame_time, const Se2& prior, const MatchResult& match);

  /// Judges the voters. Call it once per cycle, after all samples and matches. `pose_valid` says
  /// whether the latest pose was sent as valid.
  void judge(Time now, bool pose_valid);

  /// Like Tracker::pose_at(), but with MeasurementModel::constant_error added to the covariance.
  /// While Arbiter::open_dispute() returns an offset, the covariance also covers the pose at that
  /// offset.
  std::optional<TrackedPose> pose_at(Time time) const;

  const Verdict& verdict() const { return verdict_; }
  const MapOffsetMonitor& map_offset() const { return map_offset_; }
  bool odometry_implausible() const { return odometry_monitor_.implausible(); }

  /// Whether matches and GNSS together confirm a new pose: a GNSS sample of the last 2 s is near
  /// enough, and the matches support it (StartConfirmation).
  bool confirms_start(Time now) const;

  /// The bounds of the error of `pose` at `parameters.integrity_risk`: (longitudinal m, lateral m,
  /// yaw rad).
  Eigen::Vector3d protection_of(const TrackedPose& pose,
                                const ProtectionParameters& parameters) const;

  /// Forgets the pose and what the arbiter and the matches said about it. GNSS sets the pose again
  /// as at the start (Tracker::add_gnss()).
  void restart();

  /// Forgets everything but the offset between map and GNSS, because a gap in time changes neither
  /// the map nor the antenna.
  void reset();

  const Tracker& tracker() const { return tracker_; }

 private:
  TrackerUpdate add_gnss(const GnssSample& received);
  std::optional<GnssSample::Yaw> yaw_at(Time time) const;
  void weigh_start(const MatchResult& match, const MatchOutcome& outcome);
  bool gnss_confirms(Time now) const;
  bool gnss_is_recent(Time now) const;
  /// Whether a voter disagrees, so that the pose may be that of another place.
  bool is_contradicted() const;
  bool gnss_refutes() const;
  void compare_map(const GnssSample& sample);

  Tracker tracker_;
  Arbiter arbiter_;
  MapOffsetMonitor map_offset_;
  GnssScatter gnss_scatter_;
  OdometryMonitor odometry_monitor_;
  EvidenceMonitor evidence_;
  StartConfirmation start_confirmation_;
  Verdict verdict_;
  bool pose_valid_ = false;
  bool trusted_ = false;  ///< the pose was valid at least once since the start or restart
  /// Number in a row of GNSS samples that the gate refused while the arbiter trusted GNSS.
  int trusted_gnss_refused_ = 0;
  std::optional<Time> match_passed_;  ///< latest match that passed the gate
  std::optional<Time> gnss_passed_;   ///< latest trusted GNSS sample that passed the gate
  Eigen::Vector3d gnss_sigma_ = Eigen::Vector3d::Ones();  ///< sigma of that sample: (m, m, rad)
  bool gnss_has_yaw_ = false;                             ///< whether that sample has a heading
};

}  // namespace bevloc
