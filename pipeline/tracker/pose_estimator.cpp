#include "pipeline/tracker/pose_estimator.h"

#include <algorithm>
#include <cmath>

namespace bevloc {
namespace {

/// Largest GNSS errors (along, across, yaw), in standard deviations, with which the pose may become
/// valid. The limit across is the smallest, because lanes look alike.
constexpr double kConfirmingAlong = 3.0;
constexpr double kConfirmingAcross = 2.5;
constexpr double kConfirmingYaw = 3.0;
/// A GNSS error beyond this refutes the pose. By chance, one in 150,000 independent errors of an
/// axis exceeds it.
constexpr double kRefuting = 4.5;
/// The pose starts again if the estimated scale error of the wheels exceeds this many standard
/// deviations, because the wheels then slip. Without a new start, the filter would keep the error
/// after the wheels grip again.
constexpr double kMostScaleSigmas = 5.0;
/// The pose starts again after this many refused GNSS samples in a row, if no match has passed for
/// kMatchAbsence. Samples of excluded GNSS do not count, because two voters have found them wrong.
constexpr int kRefusalsToRestart = 15;
/// If the sigma of the heading exceeds this, the pose starts again, because the filter is linear in
/// the heading. Only a gap in the odometry makes the sigma so large.
constexpr double kMostYawSigma_rad = radians(30.0);
/// Refused matches in a row after which a pose that was never valid starts again.
constexpr int kRefusalsToStartAgain = 5;
constexpr Duration kMatchAbsence = std::chrono::seconds(1);
/// While the vehicle is slower, map and GNSS are not compared. An error of GNSS by reflections
/// lasts as long as the vehicle stands, so it looks like an offset of the map.
constexpr double kComparing_mps = 1.0;
/// While the pose is not valid, the support of its matches counts for this long after the latest
/// match. After that, the vehicle may be in another lane.
constexpr Duration kSupportLifetime = std::chrono::seconds(5);

/// Only GNSS supports a new or lost pose, and a receiver may claim to be more exact than it is.
/// With this sigma, right matches outweigh GNSS.
GnssSample with_start_sigma(GnssSample sample) {
  for (double* sigma_m : {&sample.sigma_east_m, &sample.sigma_north_m}) {
    if (*sigma_m > 0.0) *sigma_m = std::max(*sigma_m, StartConfirmation::kLeastGnssSigma_m);
  }
  return sample;
}

bool reached_the_gate(TrackerUpdate update) {
  return update == TrackerUpdate::kAccepted || update == TrackerUpdate::kGated;
}

}  // namespace

TrackerUpdate PoseEstimator::add(const VehicleSample& sample) {
  if (const auto* gnss = std::get_if<GnssSample>(&sample)) return add_gnss(*gnss);
  const OdometrySample& odometry = std::get<OdometrySample>(sample);
  // The monitors must not learn from a sample that nobody can use.
  if (const auto refusal = tracker_.refusal_of(odometry)) return *refusal;
  if (!odometry_monitor_.accept(odometry)) {
    gnss_scatter_.forget_samples();
    return TrackerUpdate::kImplausible;
  }
  start_confirmation_.add(odometry);
  arbiter_.add_odometry(odometry.time, odometry.wheel_lean);
  gnss_scatter_.add(odometry);
  return tracker_.add_odometry(odometry);
}

std::optional<GnssSample::Yaw> PoseEstimator::yaw_at(Time time) const {
  const auto pose = tracker_.pose_at(time);
  if (!pose) return std::nullopt;
  return GnssSample::Yaw{pose->map_from_vehicle.yaw_rad, std::sqrt(pose->covariance(2, 2))};
}

TrackerUpdate PoseEstimator::add_gnss(const GnssSample& received) {
  const auto yaw = yaw_at(received.time);
  const GnssSample at_axle = received.antenna ? at_rear_axle(received, yaw) : received;
  GnssSample sample = gnss_scatter_.with_seen_sigma(at_axle);
  if (!pose_valid_) sample = with_start_sigma(sample);
  const bool had_pose = tracker_.is_initialised();
  const bool trusted = arbiter_.trusts_gnss();
  const TrackerUpdate update = tracker_.add_gnss(sample, trusted ? Trust::kUse : Trust::kExamine);
  if (update == TrackerUpdate::kAccepted && trusted) {
    const GnssPose gnss = gnss_pose(sample);
    gnss_passed_ = sample.time;
    const MeasurementModel& model = tracker_.parameters().measurements;
    gnss_sigma_.head<2>().setConstant(
        std::max(gnss.position_sigma_m, model.gnss_min_position_sigma_m));
    gnss_sigma_.z() = std::max(gnss.yaw_sigma_rad, model.gnss_min_yaw_sigma_rad);
    gnss_has_yaw_ = gnss.has_yaw;
  }
  if (!had_pose || !reached_the_gate(update)) return update;
  if (yaw) gnss_scatter_.add(at_axle, yaw->yaw_rad);
  const bool passes = update == TrackerUpdate::kAccepted;
  std::optional<GnssError> error;
  if (pose_valid_) error = tracker_.gnss_error();
  arbiter_.add_gnss(sample.time, tracker_.latest_innovation(), passes, error);
  trusted_gnss_refused_ = passes || !trusted ? 0 : trusted_gnss_refused_ + 1;
  if (passes && trusted) compare_map(sample);
  return update;
}

/// Uses only a pose with recent matches, because only such a pose has the same offset as the map,
/// and only while the vehicle drives.
void PoseEstimator::compare_map(const GnssSample& sample) {
  const bool matched = match_passed_ && sample.time - *match_passed_ <= kMatchAbsence;
  if (!matched || !(pose_valid_ || map_offset_.contradicts())) return;
  const auto pose = tracker_.pose_at(sample.time);
  if (!pose || std::abs(pose->speed_mps) < kComparing_mps) return;
  const GnssPose gnss = gnss_pose(sample);
  map_offset_.add(sample.time,
                  gnss.map_from_vehicle.translation() - pose->map_from_vehicle.translation(),
                  gnss.position_sigma_m);
}

PoseEstimator::MatchOutcome PoseEstimator::add_match(Time frame_time, const Se2& prior,
                                                     const MatchResult& match) {
  MatchResult judged = match;
  MatchOutcome outcome;
  outcome.seen = evidence_.judge(judged);
  if (!outcome.seen.place) {
    weigh_start(match, outcome);
    return outcome;
  }
  const bool trusted = arbiter_.trusts_match();
  // If the best place lies at the border of the search, the match does not say where the vehicle
  // is. But it contradicts the estimate if the gate refuses that place.
  if (outcome.seen.at_border.any()) {
    outcome.update = tracker_.add_correction(frame_time, prior, judged, Trust::kExamine);
    forget_border(outcome.seen, judged);
  }
  if (outcome.update != TrackerUpdate::kGated) {
    outcome.update =
        tracker_.add_correction(frame_time, prior, judged, trusted ? Trust::kUse : Trust::kExamine);
  }
  if (!reached_the_gate(outcome.update)) return outcome;
  const bool passes = outcome.update == TrackerUpdate::kAccepted;
  arbiter_.add_match(frame_time, tracker_.latest_innovation(), passes);
  if (!trusted) outcome.update = TrackerUpdate::kGated;
  if (passes && trusted) match_passed_ = frame_time;
  weigh_start(match, outcome);
  return outcome;
}

void PoseEstimator::weigh_start(const MatchResult& match, const MatchOutcome& outcome) {
  if (outcome.update == TrackerUpdate::kGated || outcome.seen.at_border.y()) {
    // While the pose is valid, the arbiter judges a refused match.
    if (!pose_valid_) start_confirmation_.reset();
    return;
  }
  start_confirmation_.add({.score = match.score,
                           .along_score = match.axis_score.x(),
                           .along_growth = EvidenceMonitor::growth_of(match.axis_score.x()),
                           .sees = outcome.seen.confirms_start()});
}

void PoseEstimator::judge(Time now, bool pose_valid) {
  const bool is_lost = pose_valid_ && !pose_valid;
  // Without a pose nothing tells whether the vehicle is still where it was.
  const std::optional<GnssSample::Yaw> yaw = yaw_at(now);
  const bool is_gone = !yaw;
  const bool is_unseen = !pose_valid && match_passed_ && now - *match_passed_ > kSupportLifetime;
  if (is_gone || is_unseen || (is_lost && is_contradicted())) start_confirmation_.reset();
  pose_valid_ = pose_valid;
  trusted_ = trusted_ || pose_valid;
  const bool odometry_was_wrong = verdict_.odometry_contradicts;
  const PoseStanding lost_or_new = trusted_ ? PoseStanding::kLost : PoseStanding::kNew;
  verdict_ = arbiter_.judge(now, pose_valid ? PoseStanding::kValid : lost_or_new);
  verdict_.map_contradicts = map_offset_.contradicts();
  // GNSS does not contradict the pose while no samples come.
  const bool gnss_speaks = arbiter_.gnss_speaks(now);
  if (!gnss_speaks) trusted_gnss_refused_ = 0;
  verdict_.gnss_contradicts =
      gnss_speaks && (verdict_.gnss_contradicts || gnss_scatter_.contradicts());
  verdict_.gnss_excluded = gnss_speaks && verdict_.gnss_excluded;
  if (verdict_.odometry_contradicts && !odometry_was_wrong) tracker_.widen();
  if (arbiter_.odometry_drifts()) {
    tracker_.loosen_odometry();
    arbiter_.forget_drift(now);
  }
  const bool matched = match_passed_ && now - *match_passed_ <= kMatchAbsence;
  const bool gnss_refused = trusted_gnss_refused_ >= kRefusalsToRestart && !matched;
  const bool start_failed =
      !trusted_ && arbiter_.matches_refused_in_a_row() >= kRefusalsToStartAgain;
  const bool wheels_slip = std::abs(tracker_.speed_scale_error()) >
                           kMostScaleSigmas * tracker_.parameters().initial_speed_scale_sigma;
  const bool heading_lost = yaw && yaw->sigma_rad > kMostYawSigma_rad;
  if (gnss_refutes() || gnss_refused || start_failed || wheels_slip || heading_lost) {
    restart();
    verdict_.undecided = true;
    verdict_.odometry_contradicts = verdict_.odometry_contradicts || wheels_slip;
  }
}

std::optional<TrackedPose> PoseEstimator::pose_at(Time time) const {
  auto pose = tracker_.pose_at(time);
  if (!pose) return pose;
  pose->covariance.diagonal() += tracker_.parameters().measurements.constant_error.cwiseAbs2();
  if (const auto dispute = arbiter_.open_dispute()) {
    // Adds the variance of a mixture of two equally likely places.
    pose->covariance.diagonal() += 0.25 * dispute->cwiseAbs2();
  }
  return pose;
}

bool PoseEstimator::confirms_start(Time now) const {
  return gnss_confirms(now) &&
         start_confirmation_.confirms(tracker_.gnss_error().in_vehicle(), gnss_sigma_.x());
}

bool PoseEstimator::is_contradicted() const {
  return verdict_.undecided || verdict_.odometry_contradicts || verdict_.match_contradicts ||
         odometry_monitor_.implausible();
}

bool PoseEstimator::gnss_is_recent(Time now) const {
  return gnss_passed_ && now - *gnss_passed_ <= Arbiter::kGnssLifetime;
}

bool PoseEstimator::gnss_confirms(Time now) const {
  if (!gnss_is_recent(now) || arbiter_.gnss_refused_in_a_row() > 0) return false;
  const Eigen::Vector3d error = tracker_.gnss_error().in_vehicle().cwiseAbs();
  return error.x() <= kConfirmingAlong && error.y() <= kConfirmingAcross &&
         error.z() <= kConfirmingYaw;
}

bool PoseEstimator::gnss_refutes() const {
  return arbiter_.trusts_gnss() &&
         tracker_.gnss_error().in_vehicle().cwiseAbs().maxCoeff() > kRefuting;
}

Eigen::Vector3d PoseEstimator::protection_of(const TrackedPose& pose,
                                             const ProtectionParameters& parameters) const {
  const double gnss_correlation_s = tracker_.parameters().correlation.gnss_s;
  const double since_gnss_s = gnss_passed_ ? to_seconds(pose.time - *gnss_passed_) : 0.0;
  std::optional<GnssView> view;
  if (gnss_is_recent(pose.time)) {
    view = GnssView{tracker_.gnss_error().in_vehicle(), gnss_sigma_, gnss_has_yaw_};
  }
  return protection_level(pose.covariance.diagonal().cwiseSqrt(), view,
                          gnss_correlation_s + since_gnss_s, parameters);
}

void PoseEstimator::restart() {
  tracker_.restart();
  arbiter_.reset();
  evidence_.reset();
  start_confirmation_.reset();
  pose_valid_ = false;
  trusted_ = false;
  trusted_gnss_refused_ = 0;
  match_passed_.reset();
  gnss_passed_.reset();
}

void PoseEstimator::reset() {
  restart();
  tracker_.reset();
  odometry_monitor_.reset();
  const TrackerParameters& parameters = tracker_.parameters();
  gnss_scatter_ = GnssScatter(parameters.measurements, parameters.correlation.gnss_s);
}

}  // namespace bevloc
