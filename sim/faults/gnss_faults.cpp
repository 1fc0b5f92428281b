#include "sim/faults/gnss_faults.h"

#include <algorithm>
#include <cmath>

#include "sim/faults/old_readings.h"

namespace bevloc::sim {
namespace {

constexpr OldReadingKinds kOldGnss{FaultKind::kGnssStuck, FaultKind::kGnssLate};

/// The sum of an offset along the map's axes and one along the vehicle's.
Eigen::Vector2d in_map(const Eigen::Vector2d& east_north, const Eigen::Vector2d& along_across,
                       double yaw_rad) {
  const Se2 map_from_vehicle_directions{0.0, 0.0, yaw_rad};
  return east_north + map_from_vehicle_directions * along_across;
}

/// The share of the offset that a spoofer has reached. It rises smoothly from 0 to 1.
double pulled_share(double elapsed_s, double pull_s) {
  if (elapsed_s >= pull_s) return 1.0;
  const double part = elapsed_s / pull_s;
  return part * part * (3.0 - 2.0 * part);
}

/// The offset `since_s` after the fault began.
Eigen::Vector2d offset_of(const Fault& fault, double since_s, double time_s, const Drive& drive) {
  const FaultAmounts& by = fault.amounts;
  const auto yaw_at = [&drive](double at_s) { return drive.at(at_s).map_from_vehicle.yaw_rad; };
  switch (fault.kind) {
    case FaultKind::kGnssJump:
      return in_map({by.east_m, by.north_m}, {by.along_m, by.across_m}, yaw_at(time_s));
    case FaultKind::kGnssRamp:
      return since_s *
             in_map({by.east_mps, by.north_mps}, {by.along_mps, by.across_mps}, yaw_at(time_s));
    case FaultKind::kGnssSpoof:
      // A spoofer moves the whole track alike, so the heading at its first moment counts.
      return pulled_share(since_s, by.pull_s) *
             in_map({by.east_m, by.north_m}, {by.along_m, by.across_m}, yaw_at(time_s - since_s));
    default:
      return Eigen::Vector2d::Zero();
  }
}

}  // namespace

std::optional<GnssReading> reading_with_faults(const GnssSimulator& gnss, size_t index,
                                               std::span<const Fault> active, const Drive& drive) {
  const double time_s = static_cast<double>(index) * GnssSimulator::kPeriod_s;
  GnssReading reading = gnss.reading(sent_index(index, GnssSimulator::kPeriod_s, kOldGnss, active));
  const Se2 truth = drive.at(reading.time_s).map_from_vehicle;
  for (const Fault& fault : active) {
    reading.position_m += offset_of(fault, time_s - fault.from_s, time_s, drive);
    switch (fault.kind) {
      case FaultKind::kGnssOutage:
        return std::nullopt;
      case FaultKind::kGnssNoHeading:
        reading.has_heading = false;
        break;
      case FaultKind::kGnssWrongSigma:
        reading.position_sigma_m *= fault.amounts.factor;
        reading.heading_sigma_rad *= fault.amounts.factor;
        break;
      case FaultKind::kGnssNoise:
        reading.position_m =
            truth.translation() + fault.amounts.factor * (reading.position_m - truth.translation());
        reading.heading_rad = wrap_angle(
            truth.yaw_rad + fault.amounts.factor * wrap_angle(reading.heading_rad - truth.yaw_rad));
        break;
      case FaultKind::kGnssJump:
        reading.heading_rad = wrap_angle(reading.heading_rad + radians(fault.amounts.heading_deg));
        break;
      default:
        break;
    }
  }
  return reading;
}

}  // namespace bevloc::sim
