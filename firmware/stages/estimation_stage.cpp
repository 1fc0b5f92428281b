#include "firmware/stages/estimation_stage.h"

#include <cmath>

#include "firmware/threads/clock_gap.h"

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

/// Headings with a smaller share of evidence are not compared with the yaw rate.
constexpr double kLeastYawEvidence = 0.8;

Duration age(const std::optional<Time>& time, Time now) {
  return time ? now - *time : Duration::max();
}

void add_uncertainty(const TrackedPose& pose, HealthInputs& inputs) {
  inputs.longitudinal_sigma_m = std::sqrt(pose.covariance(0, 0));
  inputs.lateral_sigma_m = std::sqrt(pose.covariance(1, 1));
  inputs.yaw_sigma_rad = std::sqrt(pose.covariance(2, 2));
  inputs.internal_error = !pose.map_from_vehicle.is_finite() || !pose.covariance.allFinite();
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

void EstimationStage::tick(Time now) {
  watch_clock(now);
  take_samples();
  take_reports(now);
  // After a gap the health still has the state of the discarded pose.
  estimator_.judge(now, health_.pose_valid() && !clock_gap_);
  note_map_offset();
  const auto pose = estimator_.pose_at(now);
  if (pose) {
    protection_ = estimator_.protection_of(*pose, protection_parameters_);
  } else {
    // Matches say nothing about the pose with which the estimator will start again.
    forget_matches();
  }
  update_health(pose, now);
  note_pose(pose);
  if (pose) predictions_.push({*pose, !health_.pose_valid() || wide_search_});
  publish(pose, now);
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
  stamp_monitor_.reset();
  stamps_jumped_ = latest_stamps_jumped_ = false;
  last_tick_.reset();
  odometry_time_.reset();
  gnss_time_.reset();
  latest_report_.reset();
  forget_matches();
}

void EstimationStage::forget_matches() {
  accepted_frame_time_.reset();
  confirmed_time_.reset();
  unsent_correction_.reset();
  accepted_in_a_row_ = 0;
  refused_in_a_row_ = 0;
}

void EstimationStage::sign_off(Time now) {
  can::PoseReport report = begin_report();
  report.status.state = HealthState::kLost;
  report.status.why |= Why::kPoseStale;
  report.pose_time = now;
  publisher_.publish(report, now);
}

void EstimationStage::take_samples() {
  while (const auto sample = samples_.pop(Duration::zero())) {
    const auto* odometry = std::get_if<OdometrySample>(&*sample);
    const bool is_odometry = odometry != nullptr;
    if (is_odometry) stamp_monitor_.add_rate(odometry->time, odometry->yaw_rate_radps);
    const TrackerUpdate outcome = estimator_.add(*sample);
    ++(is_odometry ? counters_.odometry : counters_.gnss)[index_of(outcome)];
    // A GNSS sample that the gate refuses is there, but contradicts. One that waits for a heading
    // is there, too.
    const bool arrived = outcome == TrackerUpdate::kAccepted ||
                         outcome == TrackerUpdate::kNoHeading ||
                         (!is_odometry && outcome == TrackerUpdate::kGated);
    if (!arrived) continue;
    std::optional<Time>& latest = is_odometry ? odometry_time_ : gnss_time_;
    latest = std::visit([](const auto& taken) { return taken.time; }, *sample);
  }
}

void EstimationStage::note_map_offset() {
  const MapOffsetMonitor& monitor = estimator_.map_offset();
  for (int axis = 0; axis < 2; ++axis) {
    const double offset_cm = 100.0 * monitor.offset_m()(axis);
    counters_.map_offset_cm[axis] =
        monitor.contradicts() ? static_cast<int>(std::lround(offset_cm)) : 0;
  }
}

void EstimationStage::watch_clock(Time now) {
  if (last_tick_ && now - *last_tick_ > ClockGapDetector::kGap) note_clock_gap();
  last_tick_ = now;
}

void EstimationStage::take_reports(Time now) {
  while (const auto report = reports_.pop(Duration::zero())) {
    latest_report_ = *report;
    latest_report_arrival_ = now;
    network_fault_ = network_fault_ || report->network_fault;
    if (report->had_prior) add_correction(*report);
    note_stamps(report->stamps_jumped);
    compare_heading(*report);
  }
  // If all cameras stop, there are no more reports that say so.
  if (now - latest_report_arrival_ > report_lifetime_) latest_report_.reset();
}

/// After a jump, what was learned about the earlier stamps no longer holds.
void EstimationStage::note_stamps(bool jumped) {
  if (jumped != latest_stamps_jumped_) stamp_monitor_.reset();
  stamps_jumped_ = jumped && (stamps_jumped_ || !latest_stamps_jumped_);
  latest_stamps_jumped_ = jumped;
  if (stamp_monitor_.agrees()) stamps_jumped_ = false;
}

void EstimationStage::compare_heading(const VisionReport& report) {
  constexpr int kYaw = 2;
  if (!report.had_prior || report.match.evidence != Evidence::kGood ||
      report.match.evidence_share(kYaw) < kLeastYawEvidence) {
    return;
  }
  stamp_monitor_.add_heading(report.frame_time, (report.prior * report.match.correction).yaw_rad);
  const auto& estimate = stamp_monitor_.estimate();
  const bool contradicts = stamp_monitor_.contradicts() && estimate;
  using std::chrono::duration_cast;
  using std::chrono::milliseconds;
  counters_.stamp_offset_ms =
      contradicts ? static_cast<int>(duration_cast<milliseconds>(estimate->offset).count()) : 0;
}

void EstimationStage::add_correction(const VisionReport& report) {
  const auto [outcome, seen] = estimator_.add_match(report.frame_time, report.prior, report.match);
  wide_search_ = seen.at_border.any();
  ++counters_.corrections[index_of(outcome)];
  if (outcome == TrackerUpdate::kAccepted) {
    refused_in_a_row_ = 0;
    accepted_frame_time_ = report.frame_time;
    unsent_correction_ = report.frame_time;
    if (seen.confirms()) confirmed_time_ = report.frame_time;
    accepted_in_a_row_ = seen.confirms_start() ? accepted_in_a_row_ + 1 : 0;
  } else if (outcome != TrackerUpdate::kNoEvidence) {
    ++refused_in_a_row_;
    accepted_in_a_row_ = 0;
  }
}

HealthInputs EstimationStage::health_inputs(const std::optional<TrackedPose>& pose,
                                            Time now) const {
  HealthInputs inputs;
  inputs.initialized = pose.has_value();
  inputs.odometry_age = age(odometry_time_, now);
  inputs.gnss_age = age(gnss_time_, now);
  inputs.correction_age = age(confirmed_time_, now);
  inputs.match_age = age(accepted_frame_time_, now);
  inputs.valid_age = age(valid_since_, now);
  if (latest_report_) {
    inputs.cameras_present = latest_report_->present;
    inputs.cameras_unsynchronized = latest_report_->unsynchronized;
    inputs.map_nearby = latest_report_->map_nearby || !latest_report_->had_prior;
    inputs.overloaded = latest_report_->skipped;
    inputs.calibration_fault = latest_report_->calibration_fault.any();
  }
  inputs.stamps_contradict = stamp_monitor_.contradicts() || stamps_jumped_;
  inputs.network_fault = network_fault_;
  inputs.latest_correction_refused = refused_in_a_row_ > 0;
  inputs.accepted_in_a_row = accepted_in_a_row_;
  inputs.refused_in_a_row = refused_in_a_row_;
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
    accepted_in_a_row_ = 0;
    refused_in_a_row_ = 0;
    counters_.lost_why = health_.why().bits();
    ++counters_.lost;
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

can::PoseReport EstimationStage::begin_report() const {
  can::PoseReport report;
  report.status = make_status();
  report.clock = clock_.load();
  report.status.time_source = report.clock.source;
  return report;
}

void EstimationStage::publish(const std::optional<TrackedPose>& pose, Time now) {
  can::PoseReport report = begin_report();
  counters_.time_source = report.clock.source;
  report.capture_time = accepted_frame_time_;
  report.pose_time = now;
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
  publisher_.publish(report, now);
  if (report_observer_) report_observer_(report);
  if (health_.pose_valid() && unsent_correction_) {
    counters_.latency.add(now - *unsent_correction_);
    if (correction_observer_) correction_observer_(*unsent_correction_);
  }
  unsent_correction_.reset();
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
