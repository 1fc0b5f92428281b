// A time, a map origin and a report of an appliance in state TRACKING, for the tests of messages.
#pragma once

#include <limits>

#include "can/messages/geo_reference.h"
#include "can/messages/pose_report.h"

namespace bevloc::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr can::GeodeticPosition kOrigin{49.0069, 8.4037};
inline constexpr Time kNow(std::chrono::seconds(5000));

inline can::PoseReport tracking_report(Time now) {
  can::PoseReport report;
  report.status = {.state = HealthState::kTracking,
                   .camera_ok_mask = 0b101101,
                   .odometry_ok = true,
                   .map_ok = true,
                   .map_id = 0xBEEF};
  report.capture_time = now - std::chrono::milliseconds(83);
  report.pose_time = now;
  report.map_from_vehicle = {123.456, -78.9, radians(30.0)};
  report.covariance = Eigen::Vector3d(0.04, 0.01, 1e-4).asDiagonal();
  report.protection_level = {.longitudinal_m = 1.234,
                             .lateral_m = 0.501,
                             .yaw_rad = radians(1.449),
                             .integrity_risk = 1e-5};
  report.forward_speed_mps = 13.37;
  report.yaw_rate_radps = radians(-4.2);
  report.correction = Se2{0.4321, -0.123, radians(0.57)};
  return report;
}

}  // namespace bevloc::test
