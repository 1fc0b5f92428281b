// Computes one speed for each side of the rear axle from all wheels that the vehicle measures.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "can/vehicle/vehicle_binding.h"

namespace bevloc::can {

/// The rear axle as OdometryCheck judges it.
struct RearSpeeds {
  double left_mps = 0.0;
  double right_mps = 0.0;
  /// Whether each side was measured. Otherwise one was computed from the other and the yaw rate.
  bool both_sides = true;
};

/// Collects the wheels of one moment. Each wheel gives the speed of the middle of the rear axle. A
/// rear wheel differs from it by yaw rate times half the track. A front wheel also moves across the
/// vehicle, by yaw rate times wheelbase. If there are three wheels or more, those that differ from
/// the median by more than `kSlip_mps` plus `kSlipShare` of it slip or lock, and are left out. One
/// thread.
class WheelFusion {
 public:
  static constexpr double kSlip_mps = 0.5;
  static constexpr double kSlipShare = 0.03;

  WheelFusion(double rear_track_m, double wheelbase_m, double yaw_rate_radps)
      : half_track_m_(0.5 * rear_track_m),
        wheelbase_m_(wheelbase_m),
        yaw_rate_radps_(yaw_rate_radps) {}

  /// Adds a wheel. There may be at most five.
  void add(WheelPlace place, double speed_mps);

  /// Returns nothing if there is no wheel, or if more than half of the wheels contradict the
  /// median. The speed of a side without a good wheel is computed from the other wheels and the yaw
  /// rate.
  std::optional<RearSpeeds> speeds() const;

  /// Returns what a wheel measures when the middle of the rear axle moves at `speed_mps`: the
  /// inverse of add().
  double wheel_speed(WheelPlace place, double speed_mps) const;

 private:
  struct Estimate {
    double speed_mps = 0.0;  ///< speed of the middle of the rear axle
    int side = 0;            ///< 1 is left, -1 right, 0 the middle
  };

  double median() const;

  double half_track_m_;
  double wheelbase_m_;
  double yaw_rate_radps_;
  std::array<Estimate, 5> estimates_{};
  size_t count_ = 0;
};

}  // namespace bevloc::can
