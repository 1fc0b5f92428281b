// The sensors of a vehicle that stands at a place, and the time at which frames come.
#pragma once

#include "pipeline/tracker/tracker.h"

namespace bevloc::bench {

/// Between framesets; one bus cycle; from exposure until the pictures are decoded.
inline constexpr Duration kFramePeriod = std::chrono::milliseconds(100);
inline constexpr Duration kBusCycle = std::chrono::milliseconds(10);
inline constexpr Duration kPicturesLater = std::chrono::milliseconds(50);

/// GNSS is a little wrong, so that there is something to correct.
struct StandingVehicle {
  Se2 map_from_vehicle;

  OdometrySample odometry(Time time) const { return {time, 0.0, 0.0}; }

  GnssSample gnss(Time time) const {
    constexpr double kSigma_m = 0.5;
    constexpr double kSigma_rad = radians(0.5);
    const Se2 seen = map_from_vehicle * Se2{0.3, -0.2, radians(0.3)};
    return {time, seen.translation(), seen.yaw_rad, kSigma_m, kSigma_rad};
  }
};

}  // namespace bevloc::bench
