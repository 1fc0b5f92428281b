// The report that the localizer sends on the bus in each cycle.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "common/health_state.h"
#include "common/se2.h"
#include "common/time.h"

namespace bevloc::can {

/// Values of LOC_Status.TimeSource.
enum class TimeSource : uint8_t { kFreeRunning = 0, kPtp = 1, kGnss = 2, kNtp = 3 };

/// What LOC_Status and LOC_Clock tell about the localizer's clock.
struct ClockReport {
  TimeSource source = TimeSource::kFreeRunning;
  Duration utc_offset{};  ///< UTC since 1970 minus the localizer's clock
  Duration utc_error{};   ///< bound of its error; both are meaningless while free running
};

/// The content of LOC_Status.
struct LocalizerStatus {
  HealthState state = HealthState::kInit;
  WhyMask why{};
  TimeSource time_source = TimeSource::kFreeRunning;
  uint8_t camera_ok_mask = 0;  ///< bit i is camera i in the order of kCameraNames
  bool odometry_ok = false;
  bool gnss_ok = false;
  bool map_ok = false;
  uint16_t map_id = 0;

  bool operator==(const LocalizerStatus&) const = default;
};

/// Bounds of the error of one pose along the axes of the vehicle, at a stated integrity risk. An
/// unknown value is sent as SNA.
struct ProtectionLevel {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  double longitudinal_m = kUnknown;
  double lateral_m = kUnknown;
  double yaw_rad = kUnknown;
  /// For each axis: the largest probability that the error of one pose is beyond its bound.
  double integrity_risk = kUnknown;
};

/// One solution. Unknown values keep their default, which is sent as SNA.
struct PoseReport {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  LocalizerStatus status;
  ClockReport clock;                 ///< content of LOC_Clock; the status has its own source
  std::optional<Time> capture_time;  ///< time of the newest frames that contributed to the pose
  Time pose_time{};                  ///< the moment to which pose and velocity are predicted
  Se2 map_from_vehicle{kUnknown, kUnknown, kUnknown};
  /// Covariance of (x, y, yaw) along the axes of the map: m^2, m rad, rad^2.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Constant(kUnknown);
  ProtectionLevel protection_level;  ///< sent only with a valid pose
  double forward_speed_mps = kUnknown;
  double yaw_rate_radps = kUnknown;  ///< positive counter-clockwise
  std::optional<Se2> correction;     ///< raw dT of the newest match, used by the tracker or not
};

}  // namespace bevloc::can
