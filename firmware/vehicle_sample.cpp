#include "firmware/vehicle_sample.h"

#include <algorithm>
#include <numbers>

namespace bevloc::firmware {
namespace {

OdometrySample tracker_odometry(const can::OdometrySample& sample) {
  return {sample.time, sample.speed_mps, sample.yaw_rate_radps};
}

GnssSample tracker_gnss(const can::GnssSample& sample) {
  // A heading that is not available could be any.
  const auto yaw = sample.yaw.value_or(can::GnssSample::Yaw{0.0, std::numbers::pi});
  return {sample.time,
          {sample.east_m, sample.north_m},
          yaw.yaw_rad,
          std::max(sample.sigma_east_m, sample.sigma_north_m),
          yaw.sigma_rad};
}

}  // namespace

std::optional<VehicleSample> tracker_sample(const can::VehicleSample& sample) {
  if (const auto* odometry = std::get_if<can::OdometrySample>(&sample)) {
    return tracker_odometry(*odometry);
  }
  if (const auto* gnss = std::get_if<can::GnssSample>(&sample)) return tracker_gnss(*gnss);
  return std::nullopt;
}

bool feed(Tracker& tracker, const VehicleSample& sample) {
  const TrackerUpdate update = std::holds_alternative<OdometrySample>(sample)
                                   ? tracker.add_odometry(std::get<OdometrySample>(sample))
                                   : tracker.add_gnss(std::get<GnssSample>(sample));
  return update == TrackerUpdate::kAccepted;
}

}  // namespace bevloc::firmware
