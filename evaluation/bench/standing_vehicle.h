// The sensors of a standing vehicle, and the periods of the bench.
#pragma once

#include "common/se2.h"
#include "common/vehicle_samples.h"

namespace bevloc::bench {

inline constexpr Duration kFramePeriod = std::chrono::milliseconds(100);  ///< between framesets
inline constexpr Duration kBusCycle = std::chrono::milliseconds(10);
/// The time from exposure to decoded images.
inline constexpr Duration kImageDelay = std::chrono::milliseconds(50);

/// A vehicle that stands still. Its GNSS has a small error, so that there is something to correct.
struct StandingVehicle {
  Se2 map_from_vehicle;

  OdometrySample odometry(Time time) const { return {time, 0.0, 0.0}; }

  GnssSample gnss(Time time) const {
    constexpr double kSigma_m = 0.5;
    constexpr double kSigma_rad = radians(0.5);
    const Se2 seen = map_from_vehicle * Se2{0.3, -0.2, radians(0.3)};
    return {time,     seen.x_m, seen.y_m,
            kSigma_m, kSigma_m, GnssSample::Yaw{seen.yaw_rad, kSigma_rad}};
  }
};

}  // namespace bevloc::bench
