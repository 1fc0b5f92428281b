#include "firmware/stages/estimation_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bevloc::firmware {
namespace {

/// Rotates the covariance of a pose from the vehicle frame into the axes of the map.
Eigen::Matrix3d map_covariance(const TrackedPose& pose) {
  const double c = std::cos(pose.map_from_vehicle.yaw_rad);
  const double s = std::sin(pose.map_from_vehicle.yaw_rad);
  Eigen::Matrix3d map_from_vehicle;
  map_from_vehicle << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return map_from_vehicle * pose.covariance * map_from_vehicle.transpose();
}

constexpr size_t index_of(TrackerUpdate outcome) {
  return static_cast<size_t>(outcome);
}

/// Framesets that are further apart than this count as missing.
constexpr Duration kSlowFramesets = std::chrono::milliseconds(500);

Duration age(const std::optional<Time>& time, Time now) {
  return time ? now - *time : Duration::max();
}

void add_uncertainty(const TrackedPose& pose, HealthInputs& inputs) {
  inputs.longitudinal_sigma_m = std::sqrt(pose.covariance(0, 0));
  inputs.lateral_sigma_m = std::sqrt(pose.covariance(1, 1));
  inputs.yaw_sigma_rad = std::sqrt(pose.covariance(2, 2));
  inputs.internal_error = !pose.map_from_vehicle.is_finite() || !pose.covariance.allFinite();
}

void withhold_pose(can::LocalizerStatus& status) {
  status.state = HealthState::kLost;
  status.why |= Why::kPoseStale;
}

/// Takes back what does not hold any more after the machine was suspended. The age of the pose
/// does not show this, because the clock stood still meanwhile.
void take_back(can::PoseReport& report) {
  if (claims_pose(report.status.state)) withhold_pose(report.status);
  report.clock = {};
  report.status.time_source = report.clock.source;
}

}  // namespace

EstimationStage::EstimationStage(const TrackerParameters& tracker, const HealthLimits& limits,
                                 uint16_t map_id, can::PosePublisher& publisher,
                                 VehicleQueue& samples, VisionQueue& reports,
                                 PredictionQueue& predictions)
    : estimator_(tracker),
      health_(limits),
      publisher_(publisher),
      samples_(samples),
      reports_(reports),
      predictions_(predictions),
      protection_parameters_(limits.protection),
      report_lifetime_(limits.correction_timeout),
      map_id_(map_id) {}

void EstimationStage::observe_corrections(CorrectionObserver observer) {
  correction_observer_ = std::move(observer);
}

void EstimationStage::observe_reports(ReportObserver observer) {
  report_observer_ = std::move(observer);
}

void EstimationStage::tick(const drivers::Clock& clock) {
  const Time now = clock.now();
  if (clock_gaps_.look(now, clock.suspended())) note_clock_gap();
  take_samples();
  take_reports(now);
  // After a gap the health still has the state of the discarded pose.
  estimator_.judge(now, health_.pose_valid() && !clock_gap_);
  note_map_offset();
  watch_gnss_lag();
  const auto pose = estimator_.pose_at(now);
  if (pose) {
    protection_ = estimator_.protection_of(*pose, protection_parameters_);
  } else {
    // Matches say nothing about the pose with which the estimator will start again.
    matches_.forget();
  }
  update_health(pose, now);
  note_pose(pose);
  if (pose) predictions_.push({*pose, !health_.pose_valid() || matches_.wide_search()});
  publish(pose, now, clock);
  ++counters_.ticks;
}

void EstimationStage::note_clock_gap() {
  ++counters_.clock_gaps;
  clock_gap_ = true;
  while (samples_.pop(Duration::zero())) {
  }
  while (reports_.pop(Duration::zero())) {
  }
  estimator_.reset();
  stamps_.note_gap();
  gnss_lag_.note_gap();
  odometry_time_.reset();
  gnss_time_.reset();
  latest_report_.reset();
  matches_.forget();
}

void EstimationStage::sign_off(Time now) {
  can::PoseReport report = begin_report();
  withhold_pose(report.status);
  report.pose_time = now;
  publisher_.publish(report, now);
}

void EstimationStage::take_samples() {
  while (const auto sample = samples_.pop(Duration::zero())) {
    const auto* odometry = std::get_if<OdometrySample>(&*sample);
    const bool is_odometry = odometry != nullptr;
    if (!is_odometry) gnss_lag_.add(std::get<GnssSample>(*sample));
    const TrackerUpdate outcome = estimator_.add(*sample);
    // The yaw rate of a sample that the estimator refuses is wrong. If more are refused, the
    // monitors see a gap and begin anew.
    if (is_odometry && outcome == TrackerUpdate::kAccepted) {
      stamps_.add_rate(odometry->time, odometry->yaw_rate_radps);
      gnss_lag_.add_rate(odometry->time, odometry->yaw_rate_radps);
    }
    ++(is_odometry ? counters_.odometry : counters_.gnss)[index_of(outcome)];
    // A GNSS sample counts as arrived even if the gate refuses it, or if it waits for a heading or
    // for odometry.
    const bool gnss_is_there = outcome == TrackerUpdate::kNoHeading ||
                               outcome == TrackerUpdate::kNoOdometry ||
                               outcome == TrackerUpdate::kGated;
    const bool arrived = outcome == TrackerUpdate::kAccepted || (!is_odometry && gnss_is_there);
    if (!arrived) continue;
    std::optional<Time>& latest = is_odometry ? odometry_time_ : gnss_time_;
    latest = std::visit([](const auto& taken) { return taken.time; }, *sample);
  }
}

/// Does not watch GNSS that is excluded: it does no harm, and its headings may be wrong for another
/// reason.
void EstimationStage::watch_gnss_lag() {
  if (estimator_.verdict().gnss_excluded) gnss_lag_.reset();
  counters_.gnss_lag_ms = gnss_lag_.lag_ms();
}

void EstimationStage::note_map_offset() {
  const MapOffsetMonitor& monitor = estimator_.map_offset();
  for (int axis = 0; axis < 2; ++axis) {
    const double offset_cm = 100.0 * monitor.offset_m()(axis);
    counters_.map_offset_cm[axis] =
        monitor.contradicts() ? static_cast<int>(std::lround(offset_cm)) : 0;
  }
}

void EstimationStage::take_reports(Time now) {
  while (const auto report = reports_.pop(Duration::zero())) {
    report_interval_ = std::min(now - latest_report_arrival_, kSlowFramesets);
    latest_report_ = *report;
    latest_report_arrival_ = now;
    network_fault_ = network_fault_ || report->network_fault;
    if (report->had_prior) add_correction(*report);
    stamps_.add_report(*report);
    counters_.stamp_offset_ms = stamps_.offset_ms();
  }
  // If all cameras stop, no report comes, so the latest one expires.
  const Duration lifetime = std::max(report_lifetime_, 2 * report_interval_);
  if (now - latest_report_arrival_ > lifetime) latest_report_.reset();
}

void EstimationStage::add_correction(const VisionReport& report) {
  const auto outcome = estimator_.add_match(report.frame_time, report.prior, report.match);
  matches_.add(report.frame_time, outcome);
  ++counters_.corrections[index_of(outcome.update)];
}

HealthInputs EstimationStage::health_inputs(const std::optional<TrackedPose>& pose,
                                            Time now) const {
  HealthInputs inputs;
  inputs.initialized = pose.has_value();
  inputs.odometry_age = age(odometry_time_, now);
  inputs.gnss_age = age(gnss_time_, now);
  inputs.correction_age = age(matches_.confirmed_time(), now);
  inputs.match_age = age(matches_.accepted_time(), now);
  inputs.valid_age = age(valid_since_, now);
  if (latest_report_) {
    inputs.cameras_present = latest_report_->present;
    inputs.cameras_unsynchronized = latest_report_->unsynchronized;
    inputs.map_nearby = latest_report_->map_nearby || !latest_report_->had_prior;
    inputs.overloaded = latest_report_->skipped;
    inputs.calibration_fault = latest_report_->calibration_fault.any();
  }
  inputs.stamps_contradict = stamps_.contradicts();
  inputs.gnss_lags = gnss_lag_.contradicts();
  inputs.network_fault = network_fault_;
  inputs.latest_correction_refused = matches_.refused_in_a_row() > 0;
  inputs.accepted_in_a_row = matches_.accepted_in_a_row();
  inputs.refused_in_a_row = matches_.refused_in_a_row();
  inputs.verdict = estimator_.verdict();
  const WhyMask vehicle_input = vehicle_input_ != nullptr ? vehicle_input_->why(now) : WhyMask();
  inputs.odometry_implausible =
      estimator_.odometry_implausible() || vehicle_input.has(Why::kOdometryImplausible);
  inputs.foreign_sender = vehicle_input.has(Why::kForeignSender);
  inputs.start_confirmed = estimator_.confirms_start(now);
  inputs.clock_gap = clock_gap_;
  if (pose) {
    add_uncertainty(*pose, inputs);
    inputs.protection_level = protection_;
  }
  return inputs;
}

void EstimationStage::update_health(const std::optional<TrackedPose>& pose, Time now) {
  const HealthInputs inputs = health_inputs(pose, now);
  // The reason stays until the pose is found again, so that a reader of LOC_Status sees it.
  if (pose && inputs.accepted_in_a_row > 0) clock_gap_ = false;
  if (health_.update(inputs) && health_.state() == HealthState::kLost) {
    matches_.restart_counts();
    count_loss(health_.why());
  }
  note_validity(now);
  counters_.state = health_.state();
  counters_.why = health_.why().bits();
  counters_.cameras = static_cast<unsigned>(inputs.cameras_present.to_ulong());
}

void EstimationStage::note_validity(Time now) {
  if (health_.pose_valid() == valid_since_.has_value()) return;
  if (valid_since_) {
    valid_since_.reset();
    counters_.invalid_since = now;
  } else {
    valid_since_ = now;
    counters_.invalid_since = Time::max();
  }
}

void EstimationStage::note_pose(const std::optional<TrackedPose>& pose) {
  PoseSnapshot snapshot;
  if (pose) {
    snapshot.known = true;
    snapshot.valid = health_.pose_valid();
    snapshot.time = pose->time;
    snapshot.map_from_vehicle = pose->map_from_vehicle;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<size_t>(axis);
      snapshot.sigma[at] = std::sqrt(pose->covariance(axis, axis));
      snapshot.protection_level[at] = protection_(axis);
    }
    snapshot.longitudinal_lateral_covariance_m2 = pose->covariance(0, 1);
    snapshot.speed_mps = pose->speed_mps;
    snapshot.yaw_rate_radps = pose->yaw_rate_radps;
  }
  counters_.pose.store(snapshot);
}

void EstimationStage::count_loss(WhyMask why) {
  counters_.lost_why = why.bits();
  ++counters_.lost;
}

/// Counts a loss when a valid pose is withheld. If several poses in a row are withheld, that is one
/// loss.
void EstimationStage::note_sent(const can::LocalizerStatus& sent) {
  counters_.time_source = sent.time_source;
  const bool withheld = health_.pose_valid() && !claims_pose(sent.state);
  const bool was_withheld = std::exchange(withheld_, withheld);
  if (withheld && !was_withheld) count_loss(sent.why);
}

can::PoseReport EstimationStage::begin_report() {
  // The supervising thread has a lower priority, so this thread must not wait for it.
  if (const auto note = clock_.try_load()) clock_note_ = *note;
  can::PoseReport report;
  report.status = make_status();
  if (clock_note_.gaps == counters_.clock_gaps) report.clock = clock_note_.clock;
  report.status.time_source = report.clock.source;
  return report;
}

void EstimationStage::publish(const std::optional<TrackedPose>& pose, Time pose_time,
                              const drivers::Clock& clock) {
  can::PoseReport report = begin_report();
  report.capture_time = matches_.accepted_time();
  report.pose_time = pose_time;
  if (pose) {
    report.map_from_vehicle = pose->map_from_vehicle;
    report.covariance = map_covariance(*pose);
    report.protection_level = {protection_.x(), protection_.y(), protection_.z(),
                               protection_parameters_.integrity_risk};
    report.forward_speed_mps = pose->speed_mps;
    report.yaw_rate_radps = pose->yaw_rate_radps;
  }
  if (latest_report_ && latest_report_->match.evidence == Evidence::kGood) {
    report.correction = latest_report_->match.correction;
  }
  if (clock.suspended() - clock_gaps_.suspended() > can::kMaxPoseAge) take_back(report);
  // The thread may have stood still since `pose_time`.
  const Time now = clock.now();
  report.status = publisher_.publish(report, now);
  note_sent(report.status);
  if (report_observer_) report_observer_(report);
  const auto frame_time = matches_.take_unsent();
  if (claims_pose(report.status.state) && frame_time) {
    counters_.latency.add(now - *frame_time);
    if (correction_observer_) correction_observer_(*frame_time);
  }
}

can::LocalizerStatus EstimationStage::make_status() const {
  can::LocalizerStatus status;
  status.state = health_.state();
  status.why = health_.why();
  if (latest_report_) {
    status.camera_ok_mask = static_cast<uint8_t>(latest_report_->present.to_ulong());
  }
  status.odometry_ok = !status.why.has(Why::kOdometryMissing);
  status.gnss_ok = !status.why.has(Why::kGnssMissing);
  status.map_ok = !status.why.has(Why::kOutsideMap);
  status.map_id = map_id_;
  return status;
}

}  // namespace bevloc::firmware
