// Finds GNSS samples that scatter more than their sigma says.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "common/se2.h"
#include "common/vehicle_samples.h"
#include "pipeline/tracker/measurements.h"

namespace bevloc {

/// Compares each GNSS sample with its two neighbours and with the odometry between them. A constant
/// error of GNSS, a drift and a wrong scale of the wheels cancel out, so only the noise of GNSS is
/// left. Where the noise is larger than the sigma says, the sigma is too small, and the receiver's
/// other errors are probably larger as well. (Innovation-based adaptive estimation: Mehra, "On the
/// identification of variances and adaptive Kalman filtering", 1970. This class does it without the
/// filter, so that a wrong pose does not look like noise.)
///
/// Allocates nothing. One thread.
class GnssScatter {
 public:
  /// `correlation_s` is the time constant of GNSS errors.
  GnssScatter(const MeasurementModel& model, double correlation_s)
      : model_(model), correlation_s_(correlation_s) {}

  /// Adds finite, plausible odometry.
  void add(const OdometrySample& sample);

  /// Adds a finite sample of the position of the rear axle. `yaw_rad` is the vehicle's yaw.
  void add(const GnssSample& sample, double yaw_rad);

  /// `sample` with the sigmas that the scatter of the latest samples shows. A sigma that is not
  /// positive stays as it is.
  GnssSample with_seen_sigma(GnssSample sample) const;

  /// Whether the sigma is too small by a factor of two or more.
  bool contradicts() const { return contradicts_; }

  /// Begins a new comparison, because the odometry between the samples was wrong.
  void forget_samples() { known_ = 0; }

 private:
  struct Record {
    GnssSample sample;
    Se2 start_from_vehicle;  ///< dead reckoning
    double yaw_rad = 0.0;    ///< yaw of the vehicle in the map
  };

  /// A moving average of the squared deviation of the noise in units of its expected variance.
  class Ratio {
   public:
    void add(double squared);
    double factor() const;

   private:
    double mean_ = 1.0;
  };

  Se2 start_from_vehicle_at(Time time) const;
  void compare_middle();

  MeasurementModel model_;
  double correlation_s_;
  std::optional<OdometrySample> odometry_;
  Se2 start_from_vehicle_;           ///< pose at the time of odometry_
  std::array<Record, 3> records_{};  ///< the oldest first
  size_t known_ = 0;
  Ratio position_;
  Ratio yaw_;
  bool contradicts_ = false;
};

}  // namespace bevloc
