#include "pipeline/tracker/tracker.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace bevloc {
namespace {

MeasuredMotion between(const MeasuredMotion& a, const MeasuredMotion& b, double weight_of_b) {
  return {std::lerp(a.speed_mps, b.speed_mps, weight_of_b),
          std::lerp(a.yaw_rate_radps, b.yaw_rate_radps, weight_of_b)};
}

/// After this many refused matches in a row, the match error may have changed. Fewer count as
/// outliers.
constexpr int kRefusalsForNewError = 3;

bool is_covariance(const Eigen::Matrix3d& matrix) {
  return matrix.allFinite() && matrix.isApprox(matrix.transpose(), 1e-6) &&
         matrix.llt().info() == Eigen::Success;
}

void loosen_odometry_errors(const TrackerParameters& parameters, FilterState& state) {
  state.add_sigma(FilterState::kSpeedScale, parameters.initial_speed_scale_sigma);
  state.add_sigma(FilterState::kYawRateBias, parameters.loosened_yaw_rate_bias_sigma_radps);
  state.add_sigma(FilterState::kYaw, parameters.loosened_yaw_sigma_rad);
}

void widen_pose(const TrackerParameters& parameters, FilterState& state) {
  state.add_sigma(FilterState::kX, parameters.widened_position_sigma_m);
  state.add_sigma(FilterState::kY, parameters.widened_position_sigma_m);
  state.add_sigma(FilterState::kYaw, parameters.widened_yaw_sigma_rad);
}

}  // namespace

std::string_view name_of(TrackerUpdate update) {
  switch (update) {
    case TrackerUpdate::kAccepted:
      return "accepted";
    case TrackerUpdate::kGated:
      return "gated";
    case TrackerUpdate::kNoEvidence:
      return "no evidence";
    case TrackerUpdate::kTooOld:
      return "too old";
    case TrackerUpdate::kOutOfOrder:
      return "out of order";
    case TrackerUpdate::kNoOdometry:
      return "no odometry";
    case TrackerUpdate::kNotInitialised:
      return "not initialised";
    case TrackerUpdate::kNoHeading:
      return "no heading";
    case TrackerUpdate::kNotFinite:
      return "not finite";
    case TrackerUpdate::kImplausible:
      return "implausible";
  }
  return "unknown";
}

Tracker::Tracker(const TrackerParameters& parameters)
    : parameters_(parameters),
      history_(parameters.history_capacity),
      start_heading_(parameters.initial_yaw_rate_bias_sigma_radps) {
  assert(parameters.history_capacity > 1);
}

TrackerUpdate Tracker::add(const VehicleSample& sample) {
  if (const auto* odometry = std::get_if<OdometrySample>(&sample)) return add_odometry(*odometry);
  return add_gnss(std::get<GnssSample>(sample));
}

std::optional<TrackerUpdate> Tracker::refusal_of(const OdometrySample& sample) const {
  if (!std::isfinite(sample.speed_mps) || !std::isfinite(sample.yaw_rate_radps)) {
    return TrackerUpdate::kNotFinite;
  }
  if (std::abs(sample.speed_mps) > parameters_.max_speed_mps ||
      std::abs(sample.yaw_rate_radps) > parameters_.max_yaw_rate_radps) {
    return TrackerUpdate::kImplausible;
  }
  if (last_odometry_ && sample.time <= last_odometry_->time) return TrackerUpdate::kOutOfOrder;
  return std::nullopt;
}

TrackerUpdate Tracker::add_odometry(const OdometrySample& sample) {
  if (const auto refusal = refusal_of(sample)) return *refusal;
  // After a gap the vehicle may be elsewhere, so the next match is new knowledge.
  if (!has_odometry_for(sample.time)) repetition_.forget();
  last_odometry_ = sample;
  if (!is_initialised()) start_heading_.add(sample);
  if (!is_initialised() || sample.time < history_.front().time) return TrackerUpdate::kAccepted;
  const size_t position = position_of(sample.time);
  if (position == 0) return TrackerUpdate::kTooOld;
  insert(position, {.time = sample.time,
                    .kind = TrackerEvent::Kind::kOdometry,
                    .motion = {sample.speed_mps, sample.yaw_rate_radps}});
  return TrackerUpdate::kAccepted;
}

TrackerUpdate Tracker::add_gnss(const GnssSample& sample, Trust trust) {
  const GnssPose gnss = gnss_pose(sample);
  if (!gnss.map_from_vehicle.is_finite() || !std::isfinite(sample.sigma_east_m) ||
      !std::isfinite(sample.sigma_north_m) || !std::isfinite(gnss.yaw_sigma_rad)) {
    return TrackerUpdate::kNotFinite;
  }
  if (gnss.position_sigma_m <= 0.0 || gnss.yaw_sigma_rad <= 0.0 ||
      gnss.map_from_vehicle.translation().cwiseAbs().maxCoeff() > parameters_.max_position_m) {
    return TrackerUpdate::kImplausible;
  }
  if (!has_odometry_for(sample.time)) return TrackerUpdate::kNoOdometry;
  if (!is_initialised()) return initialise(sample.time, gnss);
  return add_pose(sample.time, measurement_of(gnss), trust);
}

PoseMeasurement Tracker::measurement_of(const GnssPose& gnss) const {
  return measurement_from(gnss, parameters_.measurements, parameters_.correlation.gnss_s > 0.0);
}

TrackerUpdate Tracker::add_correction(Time frame_time, const Se2& prior, const MatchResult& result,
                                      Trust trust) {
  if (result.evidence != Evidence::kGood) return TrackerUpdate::kNoEvidence;
  if (!prior.is_finite() || !result.correction.is_finite() || !result.covariance.allFinite() ||
      !result.evidence_share.allFinite()) {
    return TrackerUpdate::kNotFinite;
  }
  if (!is_covariance(result.covariance)) return TrackerUpdate::kImplausible;
  if (!is_initialised()) return TrackerUpdate::kNotInitialised;
  if (!has_odometry_for(frame_time)) return TrackerUpdate::kNoOdometry;
  return add_pose(frame_time,
                  measurement_from(prior, result, parameters_.measurements,
                                   parameters_.correlation.match_m.array() > 0.0),
                  trust);
}

std::optional<TrackedPose> Tracker::pose_at(Time time) const {
  const size_t events_until = count_until(history_, time);
  if (events_until == 0 || !has_odometry_for(time)) return std::nullopt;
  const FilterState state = state_at(time, events_until);
  const MeasuredMotion motion = motion_at(time, events_until);
  return TrackedPose{.time = time,
                     .map_from_vehicle = state.map_from_vehicle,
                     .covariance = state.covariance.topLeftCorner<3, 3>(),
                     .speed_mps = state.speed_mps(motion),
                     .yaw_rate_radps = state.yaw_rate_radps(motion)};
}

GnssError Tracker::gnss_error() const {
  if (!is_initialised()) return {};
  const FilterState& state = history_.back().state;
  return {state.gnss_error, state.map_from_vehicle.yaw_rad};
}

double Tracker::speed_scale_error() const {
  return is_initialised() ? history_.back().state.speed_scale_error : 0.0;
}

double Tracker::yaw_rate_bias_radps() const {
  return is_initialised() ? history_.back().state.yaw_rate_bias_radps : 0.0;
}

void Tracker::widen() {
  append_now(TrackerEvent::Kind::kWiden);
}

void Tracker::loosen_odometry() {
  append_now(TrackerEvent::Kind::kLoosen);
}

void Tracker::append_now(TrackerEvent::Kind kind) {
  repetition_.forget();
  if (!is_initialised()) return;
  const TrackerEvent& latest = history_.back();
  insert(history_.size(), {.time = latest.time, .kind = kind, .motion = latest.motion});
}

void Tracker::restart() {
  refused_matches_ = 0;
  repetition_.forget();
  history_.clear();
  start_heading_.reset();
}

void Tracker::reset() {
  restart();
  last_odometry_.reset();
}

TrackerUpdate Tracker::initialise(Time time, GnssPose gnss) {
  if (!gnss.has_yaw || gnss.yaw_sigma_rad > StartHeading::kLargestSigma_rad) {
    const auto yaw =
        start_heading_.add(time, gnss.map_from_vehicle.translation(), gnss.position_sigma_m);
    if (!yaw) return TrackerUpdate::kNoHeading;
    gnss.map_from_vehicle.yaw_rad = yaw->yaw_rad;
    gnss.yaw_sigma_rad = yaw->sigma_rad;
    gnss.has_yaw = true;
  }
  TrackerEvent event{.time = time,
                     .kind = TrackerEvent::Kind::kPose,
                     .motion = {last_odometry_->speed_mps, last_odometry_->yaw_rate_radps},
                     .measurement = measurement_of(gnss)};
  event.state = state_from(event.measurement, square_of(parameters_.initial_speed_scale_sigma),
                           square_of(parameters_.initial_yaw_rate_bias_sigma_radps));
  history_.push_back(event);
  begun_ = time;
  if (last_odometry_->time > time) {
    insert(1, {.time = last_odometry_->time,
               .kind = TrackerEvent::Kind::kOdometry,
               .motion = event.motion});
  }
  return TrackerUpdate::kAccepted;
}

TrackerUpdate Tracker::add_pose(Time time, PoseMeasurement measurement, Trust trust) {
  const size_t events_until = position_of(time);
  if (events_until == 0) {
    return time < begun_ ? TrackerUpdate::kNotInitialised : TrackerUpdate::kTooOld;
  }
  const MeasuredMotion motion = motion_at(time, events_until);
  const bool is_match = measurement.source == PoseSource::kMatch;
  const FilterState state = state_at(time, events_until);
  const bool passes = passes_gate(state, trust, measurement);
  latest_innovation_.repeats = is_match && state.stands(motion);
  if (!passes) return TrackerUpdate::kGated;
  if (trust == Trust::kExamine) return TrackerUpdate::kAccepted;
  if (is_match) {
    repetition_.discount(time, motion.speed_mps, state.stands(motion), parameters_.correlation,
                         measurement);
  }
  insert(events_until, {.time = time,
                        .kind = TrackerEvent::Kind::kPose,
                        .motion = motion,
                        .measurement = measurement});
  return TrackerUpdate::kAccepted;
}

bool Tracker::passes_gate(FilterState state, Trust trust, PoseMeasurement& measurement) {
  latest_innovation_ = innovation_of(state, measurement);
  const bool passes = latest_innovation_.squared_distance <= parameters_.gate_squared_distance;
  if (measurement.source != PoseSource::kMatch) return passes;
  refused_matches_ = passes || trust == Trust::kExamine ? 0 : refused_matches_ + 1;
  if (passes) return true;

  renew_match_error(state);
  const PoseInnovation renewed = innovation_of(state, measurement);
  latest_innovation_.unexplained =
      std::min(latest_innovation_.squared_distance, renewed.squared_distance);
  measurement.has_new_error = refused_matches_ >= kRefusalsForNewError &&
                              renewed.squared_distance <= parameters_.gate_squared_distance;
  if (!measurement.has_new_error) return false;
  latest_innovation_ = renewed;
  refused_matches_ = 0;
  return true;
}

bool Tracker::has_odometry_for(Time time) const {
  return last_odometry_ && to_seconds(time - last_odometry_->time) <= parameters_.max_prediction_s;
}

MeasuredMotion Tracker::motion_at(Time time, size_t events_until) const {
  const TrackerEvent& before = history_[events_until - 1];
  if (events_until == history_.size()) return before.motion;
  const TrackerEvent& after = history_[events_until];
  return between(before.motion, after.motion,
                 to_seconds(time - before.time) / to_seconds(after.time - before.time));
}

FilterState Tracker::state_at(Time time, size_t events_until) const {
  const TrackerEvent& before = history_[events_until - 1];
  FilterState state = before.state;
  predict(between(before.motion, motion_at(time, events_until), 0.5),
          to_seconds(time - before.time), parameters_.motion, parameters_.correlation, state);
  return state;
}

size_t Tracker::position_of(Time time) const {
  const size_t events_until = count_until(history_, time);
  // A full history drops its first event to make room. The new event cannot take its place, because
  // its state is computed from the event before it.
  return history_.full() && events_until == 1 ? 0 : events_until;
}

void Tracker::insert(size_t position, const TrackerEvent& event) {
  assert(position > 0 && position <= history_.size());
  if (history_.full()) {
    assert(position > 1);
    history_.pop_front();
    --position;
  }
  history_.insert(history_.begin() + static_cast<std::ptrdiff_t>(position), event);
  replay_from(position);
  drop_old_events();
}

/// Computes the states from `position` on again. Does not apply the gate again, because it decided
/// when each measurement arrived.
void Tracker::replay_from(size_t position) {
  for (size_t i = position; i < history_.size(); ++i) {
    const TrackerEvent& before = history_[i - 1];
    TrackerEvent& event = history_[i];
    event.state = before.state;
    predict(between(before.motion, event.motion, 0.5), to_seconds(event.time - before.time),
            parameters_.motion, parameters_.correlation, event.state);
    switch (event.kind) {
      case TrackerEvent::Kind::kOdometry:
        break;
      case TrackerEvent::Kind::kPose:
        update(event.measurement, event.state);
        break;
      case TrackerEvent::Kind::kLoosen:
        loosen_odometry_errors(parameters_, event.state);
        break;
      case TrackerEvent::Kind::kWiden:
        widen_pose(parameters_, event.state);
        break;
    }
  }
}

void Tracker::drop_old_events() {
  const Time oldest = history_.back().time - from_seconds(parameters_.history_s);
  // Keeps one event at or before `oldest`, from which later states are predicted.
  while (history_.size() > 2 && history_[1].time <= oldest) history_.pop_front();
}

}  // namespace bevloc
