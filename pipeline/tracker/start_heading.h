// Finds the heading with which the tracker starts where GNSS gives none.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "common/se2.h"
#include "common/vehicle_samples.h"

namespace bevloc {

/// Compares the way between two GNSS positions with the same way by dead reckoning. The angle
/// between the two is the heading. Two positions with 1 m of sigma tell it after some 10 m.
///
/// The filter is linear in the heading, so it must not start with an unknown one: a start that is
/// wrong by more than a right angle converges late, or to another place that looks alike.
///
/// Allocates nothing. One thread.
class StartHeading {
 public:
  /// A heading with a larger sigma is too uncertain for a start.
  static constexpr double kLargestSigma_rad = 0.15;

  /// `yaw_rate_bias_sigma_radps` is the standard deviation of the unknown bias of the yaw rate.
  explicit StartHeading(double yaw_rate_bias_sigma_radps)
      : yaw_rate_bias_sigma_radps_(yaw_rate_bias_sigma_radps) {}

  /// Adds a sample that is newer than the one before.
  void add(const OdometrySample& sample);

  /// Adds a GNSS position in the map, at a time near the latest odometry sample. Returns the yaw at
  /// that time, or nothing while the way since the first position is too short. Begins again with
  /// this position if the two ways do not agree in length.
  std::optional<GnssSample::Yaw> add(Time time, const Eigen::Vector2d& position_m, double sigma_m);

  void reset();

 private:
  /// The position from which the way is measured.
  struct Begin {
    Time time;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    double sigma_m = 0.0;
  };

  void begin(const Begin& begin);

  double yaw_rate_bias_sigma_radps_;
  std::optional<OdometrySample> odometry_;  ///< the latest sample
  std::optional<Begin> begin_;
  Se2 begin_from_odometry_;  ///< the pose at the latest sample, in the vehicle frame at `begin_`
};

}  // namespace bevloc
