#include "can/messages/sample_maker.h"

#include "can/messages/message_table.h"

namespace bevloc::can {

GnssSample gnss_sample_of(const GeodeticFix& fix, GeoReference& geo, Time time) {
  const double heading_deg = fix.heading ? fix.heading->heading_deg : 0.0;
  const Se2 map_from_vehicle = geo.map_from_geodetic({fix.position, heading_deg});
  GnssSample sample{.time = time,
                    .east_m = map_from_vehicle.x_m,
                    .north_m = map_from_vehicle.y_m,
                    .sigma_east_m = fix.sigma_east_m,
                    .sigma_north_m = fix.sigma_north_m};
  if (fix.heading) sample.yaw = {map_from_vehicle.yaw_rad, radians(fix.heading->sigma_deg)};
  return sample;
}

void SampleMaker::note_unknown(const Frame& frame, const BaseIds& base) {
  const bool own_id = is_localizer_id(frame.id, base);
  ++(own_id ? own_ids_ : foreign_frames_);
  if (own_id) fault_times_.foreign_sender = latest_;
}

bool SampleMaker::accept(E2eMonitor& monitor, const E2eFrame& frame, bool has_odometry) {
  const bool accepted = monitor.accept(frame, latest_);
  if (monitor.has_second_sender()) fault_times_.foreign_sender = latest_;
  if (monitor.state() == E2eState::kInvalid && has_odometry) note_implausible();
  return accepted;
}

std::optional<OdometrySample> SampleMaker::odometry(const OdometryCheck::Wheels& wheels) {
  const bool plausible = odometry_check_.judge(wheels) == OdometryVerdict::kPlausible;
  if (odometry_check_.is_slow()) ++slow_samples_;
  if (!plausible || odometry_check_.is_slow()) note_implausible();
  if (!plausible) return std::nullopt;
  ++odometry_samples_;
  return OdometrySample{.time = wheels.time,
                        .speed_mps = wheels.speed_mps(),
                        .yaw_rate_radps = wheels.yaw_rate_radps,
                        .wheel_lean = odometry_check_.wheel_lean()};
}

GnssSample SampleMaker::gnss(const GeodeticFix& fix, Time time) {
  ++gnss_samples_;
  return gnss_sample_of(fix, geo_, time);
}

void SampleMaker::add_to(VehicleInputCounters& counters) const {
  counters.own_ids += own_ids_;
  counters.foreign += foreign_frames_;
  counters.contradicting_wheels += odometry_check_.count(OdometryVerdict::kWheelsContradictYawRate);
  counters.odometry_jumps += odometry_check_.count(OdometryVerdict::kSpeedJump) +
                             odometry_check_.count(OdometryVerdict::kYawRateJump);
  counters.sharp_turns += odometry_check_.count(OdometryVerdict::kTooSharp);
  counters.slow_odometry += slow_samples_;
  counters.odometry_samples += odometry_samples_;
  counters.gnss_samples += gnss_samples_;
}

}  // namespace bevloc::can
