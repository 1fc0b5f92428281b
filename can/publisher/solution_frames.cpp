#include "can/publisher/solution_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "can/messages/clock_message.h"
#include "can/messages/encode_quantity.h"

namespace bevloc::can {
namespace {

bool is_in_range(const Signal& signal, double value) {
  return value >= signal.min && value <= signal.max;
}

/// Whether the covariance is finite and has no negative variance along any direction or in yaw.
bool is_valid(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return false;
  const double product = covariance(0, 0) * covariance(1, 1);
  const double determinant = product - covariance(0, 1) * covariance(1, 0);
  return covariance.diagonal().minCoeff() >= 0.0 && determinant >= -1e-9 * product;
}

/// A position out of range is not sent, because a saturated position would be wrong.
bool is_sendable(const PoseReport& report) {
  return report.map_from_vehicle.is_finite() && is_valid(report.covariance) &&
         is_in_range(loc_pos_local::kEast, report.map_from_vehicle.x_m) &&
         is_in_range(loc_pos_local::kNorth, report.map_from_vehicle.y_m);
}

bool is_fresh(const PoseReport& report, Time now) {
  return now - report.pose_time <= kMaxPoseAge;
}

bool has_fresh_images(const PoseReport& report, Time now) {
  return report.capture_time && *report.capture_time <= now &&
         now - *report.capture_time <= kMaxCaptureAge;
}

double sigma_of(double variance) {
  return std::sqrt(std::max(variance, 0.0));
}

double sigma_along(const Eigen::Matrix3d& covariance, double direction_rad) {
  const Eigen::Vector2d axis(std::cos(direction_rad), std::sin(direction_rad));
  return sigma_of(axis.dot(covariance.topLeftCorner<2, 2>() * axis));
}

/// The age is that at the time `at`. An age beyond the range of the signal stays SNA, because the
/// largest value would be too small.
void encode_time(Frame& frame, Time capture_time, Time at) {
  using std::chrono::microseconds;
  const double age_ms = to_milliseconds(at - capture_time);
  if (!is_in_range(loc_time::kCaptureAge, age_ms)) return;
  const auto capture_us = std::chrono::floor<microseconds>(capture_time.time_since_epoch()).count();
  insert_raw(frame, loc_time::kCaptureTime, capture_us & UINT32_MAX);
  encode(frame, loc_time::kCaptureAge, age_ms);
}

/// Encodes position, heading and their standard deviations.
void encode_pose(Frame& latitude, Frame& longitude, Frame& local, Frame& attitude, Frame& deviation,
                 const PoseReport& report, GeoReference& geo) {
  const Se2& pose = report.map_from_vehicle;
  const Eigen::Matrix3d& covariance = report.covariance;
  const GeodeticPose geodetic = geo.geodetic_from_map(pose);

  encode(latitude, loc_latitude::kLatitude, geodetic.position.latitude_deg);
  encode_sigma(latitude, loc_latitude::kStdDev, sigma_of(covariance(1, 1)));
  encode(longitude, loc_longitude::kLongitude, geodetic.position.longitude_deg);
  encode_sigma(longitude, loc_longitude::kStdDev, sigma_of(covariance(0, 0)));
  encode(local, loc_pos_local::kEast, pose.x_m);
  encode(local, loc_pos_local::kNorth, pose.y_m);
  encode_heading(attitude, loc_attitude::kHeading, geodetic.heading_deg);

  const double sideways_rad = pose.yaw_rad + 0.5 * std::numbers::pi;
  encode_sigma(deviation, loc_std_dev::kLongitudinal, sigma_along(covariance, pose.yaw_rad));
  encode_sigma(deviation, loc_std_dev::kLateral, sigma_along(covariance, sideways_rad));
  encode_sigma(deviation, loc_std_dev::kHeading, degrees(sigma_of(covariance(2, 2))));
}

void encode_velocity(Frame& frame, const PoseReport& report) {
  encode(frame, loc_velocity::kForward, report.forward_speed_mps);
  encode(frame, loc_velocity::kYawRate, degrees(report.yaw_rate_radps));
}

void encode_correction(Frame& frame, const Se2& correction) {
  encode(frame, loc_correction::kLongitudinal, correction.x_m);
  encode(frame, loc_correction::kLateral, correction.y_m);
  encode(frame, loc_correction::kYaw, degrees(correction.yaw_rad));
}

/// Returns the largest whole exponent n for which the risk is at most 10^-n.
double risk_exponent(double risk) {
  constexpr double kLogarithmError = 1e-9;  // a whole exponent must not become one less
  return std::floor(-std::log10(risk) + kLogarithmError);
}

void encode_protection(Frame& frame, const ProtectionLevel& level) {
  encode_bound(frame, loc_integrity::kLateral, level.lateral_m);
  encode_bound(frame, loc_integrity::kLongitudinal, level.longitudinal_m);
  encode_bound(frame, loc_integrity::kYaw, degrees(level.yaw_rad));
  encode(frame, loc_integrity::kRiskExponent, risk_exponent(level.integrity_risk));
}

void insert_reasons(Frame& frame, std::span<const Signal> flags, WhyMask why, int first_bit) {
  for (size_t i = 0; i < flags.size(); ++i) {
    insert_raw(frame, flags[i], (why.bits() >> (static_cast<size_t>(first_bit) + i)) & 1);
  }
}

}  // namespace

LocalizerStatus status_to_send(const PoseReport& report, Time now) {
  LocalizerStatus status = report.status;
  if (!claims_pose(status.state)) return status;
  WhyMask reasons;
  if (!is_sendable(report)) reasons |= Why::kPoseInvalid;
  if (!is_fresh(report, now) || !has_fresh_images(report, now)) reasons |= Why::kPoseStale;
  if (reasons != WhyMask()) {
    status.state = HealthState::kLost;
    status.why |= reasons;
  }
  return status;
}

Frame status_frame(const LocalizerStatus& status, const BaseIds& base) {
  Frame frame = blank_frame(loc_status::kMessage, base);
  insert_raw(frame, loc_status::kState, static_cast<int64_t>(status.state));
  insert_raw(frame, loc_status::kTimeSource, static_cast<int64_t>(status.time_source));
  insert_raw(frame, loc_status::kMapOk, status.map_ok);
  for (size_t i = 0; i < loc_status::kCameraOk.size(); ++i) {
    insert_raw(frame, loc_status::kCameraOk[i], (status.camera_ok_mask >> i) & 1);
  }
  insert_raw(frame, loc_status::kOdometryOk, status.odometry_ok);
  insert_raw(frame, loc_status::kGnssOk, status.gnss_ok);
  insert_reasons(frame, loc_status::kWhy, status.why, 0);
  insert_raw(frame, loc_status::kMapId, status.map_id);
  return frame;
}

Frame clock_frame(const ClockReport& clock, const BaseIds& base) {
  Frame frame = blank_frame(loc_clock::kMessage, base);
  if (clock.source == TimeSource::kFreeRunning) return frame;
  const auto offset_us = std::chrono::round<std::chrono::microseconds>(clock.utc_offset).count();
  insert_raw(frame, loc_clock::kUtcOffset, offset_us & UINT32_MAX);
  encode_bound(frame, loc_clock::kUtcError, to_milliseconds(clock.utc_error));
  return frame;
}

Frame identity_frame(const Identity& identity, int item, const BaseIds& base) {
  const std::array<uint32_t, loc_identity::kItems> checksums = {
      identity.program, identity.configuration, identity.model, identity.rig, identity.map};
  Frame frame = blank_frame(loc_identity::kMessage, base);
  insert_raw(frame, loc_identity::kItem, item);
  insert_raw(frame, loc_identity::kChecksum, checksums[static_cast<size_t>(item)]);
  return frame;
}

SolutionFrames solution_frames(const PoseReport& report, const LocalizerStatus& status,
                               GeoReference& geo, const BaseIds& base, Time now) {
  SolutionFrames frames;
  std::ranges::transform(kSolutionMessages, frames.begin(),
                         [&](const Message* message) { return blank_frame(*message, base); });
  auto& [time, latitude, longitude, local, attitude, velocity, deviation, correction, integrity] =
      frames;
  const bool has_pose = claims_pose(status.state);
  if (report.capture_time && *report.capture_time <= now) {
    // A valid pose holds at CaptureTime + CaptureAge.
    encode_time(time, *report.capture_time, has_pose ? report.pose_time : now);
  }
  if (has_pose) {
    encode_pose(latitude, longitude, local, attitude, deviation, report, geo);
    encode_protection(integrity, report.protection_level);
  }
  insert_reasons(integrity, loc_integrity::kWhy, status.why, loc_integrity::kFirstWhy);
  if (is_fresh(report, now)) {
    encode_velocity(velocity, report);
    if (report.correction) encode_correction(correction, *report.correction);
  }
  return frames;
}

}  // namespace bevloc::can
