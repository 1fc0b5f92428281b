#include "can/messages/vehicle_encoder.h"

#include "can/messages/encode_quantity.h"

namespace bevloc::can {
namespace {

/// Writes the epoch and the E2E protection into the frames of one measurement.
template <size_t kCount>
void seal(std::array<Frame, kCount>& frames, std::array<E2eSender, kCount>& senders,
          uint8_t& epoch) {
  for (size_t i = 0; i < kCount; ++i) {
    insert_raw(frames[i], kEpoch, epoch);
    senders[i].protect(frames[i]);
  }
  epoch = (epoch + 1) & 0x0F;
}

}  // namespace

VehicleEncoder::VehicleEncoder(const BaseIds& base, GeodeticPosition map_origin,
                               double rear_track_m)
    : base_(base),
      geo_(map_origin),
      rear_track_m_(rear_track_m),
      odometry_senders_{E2eSender(veh_wheel_speed::kMessage.protection()),
                        E2eSender(veh_yaw_rate::kMessage.protection())},
      gnss_senders_{E2eSender(veh_gnss_latitude::kMessage.protection()),
                    E2eSender(veh_gnss_longitude::kMessage.protection()),
                    E2eSender(veh_gnss_heading::kMessage.protection())} {}

std::array<Frame, 2> VehicleEncoder::odometry(const OdometrySample& sample) {
  const double half_difference_mps = 0.5 * rear_track_m_ * sample.yaw_rate_radps;
  return odometry(WheelOdometry{.left_mps = sample.speed_mps - half_difference_mps,
                                .right_mps = sample.speed_mps + half_difference_mps,
                                .yaw_rate_radps = sample.yaw_rate_radps,
                                .front_speed_mps = sample.speed_mps,
                                .front_yaw_rate_radps = sample.yaw_rate_radps});
}

std::array<Frame, 2> VehicleEncoder::odometry(const WheelOdometry& measured) {
  std::array<Frame, 2> frames = {blank_frame(veh_wheel_speed::kMessage, base_),
                                 blank_frame(veh_yaw_rate::kMessage, base_)};
  auto& [wheels, motion] = frames;
  encode(wheels, veh_wheel_speed::kRearLeft, measured.left_mps);
  encode(wheels, veh_wheel_speed::kRearRight, measured.right_mps);
  encode(motion, veh_yaw_rate::kYawRate, degrees(measured.yaw_rate_radps));
  seal(frames, odometry_senders_, odometry_epoch_);
  return frames;
}

std::array<Frame, 3> VehicleEncoder::gnss(const GnssSample& sample) {
  std::array<Frame, 3> frames = {blank_frame(veh_gnss_latitude::kMessage, base_),
                                 blank_frame(veh_gnss_longitude::kMessage, base_),
                                 blank_frame(veh_gnss_heading::kMessage, base_)};
  auto& [latitude, longitude, heading] = frames;
  const double yaw_rad = sample.yaw ? sample.yaw->yaw_rad : 0.0;
  const GeodeticPose pose = geo_.geodetic_from_map({sample.east_m, sample.north_m, yaw_rad});
  encode(latitude, veh_gnss_latitude::kLatitude, pose.position.latitude_deg);
  encode_sigma(latitude, veh_gnss_latitude::kStdDev, sample.sigma_north_m);
  encode(longitude, veh_gnss_longitude::kLongitude, pose.position.longitude_deg);
  encode_sigma(longitude, veh_gnss_longitude::kStdDev, sample.sigma_east_m);
  if (sample.yaw) {
    encode_heading(heading, veh_gnss_heading::kHeading, pose.heading_deg);
    encode_sigma(heading, veh_gnss_heading::kStdDev, degrees(sample.yaw->sigma_rad));
  }
  seal(frames, gnss_senders_, gnss_epoch_);
  return frames;
}

}  // namespace bevloc::can
