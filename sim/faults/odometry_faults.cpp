#include "sim/faults/odometry_faults.h"

#include <algorithm>
#include <cmath>

#include "common/se2.h"
#include "sim/faults/old_readings.h"

namespace bevloc::sim {
namespace {

/// Wheels spin up or lock within this time.
constexpr double kOnset_s = 0.1;
constexpr OldReadingKinds kOldOdometry{FaultKind::kOdometryStuck, FaultKind::kOdometryLate};

/// Whether a sender with a longer period sends at this index.
bool is_due(size_t index, double period_ms) {
  if (index == 0) return true;
  const auto periods = [period_ms](size_t at) {
    return std::floor(1e3 * OdometrySimulator::kPeriod_s * static_cast<double>(at) / period_ms);
  };
  return periods(index) > periods(index - 1);
}

bool is_silent(const Fault& fault, size_t index) {
  return fault.kind == FaultKind::kOdometryMissing ||
         (fault.kind == FaultKind::kOdometrySlow && !is_due(index, fault.amounts.period_ms));
}

double speed_factor(const Fault& fault, double time_s) {
  const double factor = fault.amounts.factor;
  switch (fault.kind) {
    case FaultKind::kOdometryScaled:
      return factor;
    case FaultKind::kOdometryReversed:
      return -1.0;
    case FaultKind::kOdometrySlip:
    case FaultKind::kOdometryLock:
      return std::lerp(1.0, factor, std::min(1.0, (time_s - fault.from_s) / kOnset_s));
    default:
      return 1.0;
  }
}

void disturb(WheelReading& reading, const Fault& fault, double time_s) {
  const double factor = speed_factor(fault, time_s);
  reading.left_mps *= factor;
  reading.right_mps *= factor;
  reading.front_speed_mps *= factor;
  reading.front_yaw_rate_radps *= factor;
  switch (fault.kind) {
    case FaultKind::kOdometryWheels:
      reading.left_mps = fault.amounts.left_mps;
      reading.right_mps = fault.amounts.right_mps;
      break;
    case FaultKind::kYawRateBias:
      reading.yaw_rate_radps += radians(fault.amounts.bias_degps);
      break;
    case FaultKind::kYawRateScaled:
      reading.yaw_rate_radps *= fault.amounts.factor;
      break;
    case FaultKind::kYawRateWrong:
      reading.yaw_rate_radps = radians(fault.amounts.yaw_rate_degps);
      break;
    default:
      break;
  }
}

}  // namespace

std::optional<WheelReading> reading_with_faults(const OdometrySimulator& odometry, size_t index,
                                                double rear_track_m,
                                                std::span<const Fault> active) {
  const OdometryReading sensed =
      odometry.reading(sent_index(index, OdometrySimulator::kPeriod_s, kOldOdometry, active));
  const double half_difference_mps =
      0.5 * (rear_track_m * sensed.path_yaw_rate_radps + sensed.wheel_excess_mps);
  WheelReading reading{.left_mps = sensed.speed_mps - half_difference_mps,
                       .right_mps = sensed.speed_mps + half_difference_mps,
                       .yaw_rate_radps = sensed.yaw_rate_radps,
                       .front_speed_mps = sensed.speed_mps,
                       .front_yaw_rate_radps = sensed.path_yaw_rate_radps};
  const double time_s = static_cast<double>(index) * OdometrySimulator::kPeriod_s;
  for (const Fault& fault : active) {
    if (is_silent(fault, index)) return std::nullopt;
    disturb(reading, fault, time_s);
  }
  return reading;
}

}  // namespace bevloc::sim
