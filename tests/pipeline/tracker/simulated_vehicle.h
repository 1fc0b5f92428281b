// Simulates a vehicle on a winding road, with its odometry, GNSS and a solver.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "pipeline/tracker/tracker.h"

namespace bevloc {

inline Time at_s(double seconds) {
  return Time{} + from_seconds(seconds);
}

struct SensorErrors {
  double speed_scale = 0.0;           ///< true speed = (1 + scale) * measured
  double yaw_rate_bias_radps = 0.0;   ///< measured = true + bias
  double yaw_rate_sigma_radps = 0.0;  ///< white noise, per sample
  double gnss_position_sigma_m = 0.0;
  double gnss_yaw_sigma_rad = 0.0;
  double gnss_correlation_s = 0.0;  ///< 0: white noise
  double correction_sigma_m = 0.0;
  double correction_yaw_sigma_rad = 0.0;
};

/// First-order Gauss-Markov error.
class CorrelatedError {
 public:
  CorrelatedError(double sigma, double correlation_s)
      : sigma_(sigma), correlation_s_(correlation_s) {}

  double next(double time_s, std::mt19937& random) {
    std::normal_distribution<double> normal;
    const double keep =
        started_ && correlation_s_ > 0.0 ? std::exp(-(time_s - time_s_) / correlation_s_) : 0.0;
    value_ = keep * value_ + std::sqrt(1.0 - keep * keep) * sigma_ * normal(random);
    time_s_ = time_s;
    started_ = true;
    return value_;
  }

 private:
  double sigma_;
  double correlation_s_;
  double time_s_ = 0.0;
  double value_ = 0.0;
  bool started_ = false;
};

/// Integrates the true pose in steps of 1 ms. Times must not decrease.
class SimulatedVehicle {
 public:
  SimulatedVehicle(const SensorErrors& errors, unsigned seed)
      : errors_(errors),
        random_(seed),
        gnss_x_(errors.gnss_position_sigma_m, errors.gnss_correlation_s),
        gnss_y_(errors.gnss_position_sigma_m, errors.gnss_correlation_s),
        gnss_yaw_(errors.gnss_yaw_sigma_rad, errors.gnss_correlation_s) {}

  static double speed_mps(double time_s) { return 12.0 + 4.0 * std::sin(0.2 * time_s); }
  static double yaw_rate_radps(double time_s) { return 0.15 * std::sin(0.31 * time_s); }

  const Se2& drive_to(double time_s) {
    constexpr double kStep_s = 1e-3;
    while (time_s_ < time_s - 1e-9) {
      const double dt = std::min(kStep_s, time_s - time_s_);
      const double middle_s = time_s_ + 0.5 * dt;
      const double turn = yaw_rate_radps(middle_s) * dt;
      const double distance = speed_mps(middle_s) * dt;
      pose_ = pose_ * Se2{distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), turn};
      time_s_ += dt;
    }
    return pose_;
  }

  OdometrySample odometry(double time_s) {
    return {at_s(time_s), speed_mps(time_s) / (1.0 + errors_.speed_scale),
            yaw_rate_radps(time_s) + errors_.yaw_rate_bias_radps +
                errors_.yaw_rate_sigma_radps * normal_(random_)};
  }

  /// A sample of the current pose.
  GnssSample gnss() {
    GnssSample sample;
    sample.time = at_s(time_s_);
    sample.east_m = pose_.x_m + gnss_x_.next(time_s_, random_);
    sample.north_m = pose_.y_m + gnss_y_.next(time_s_, random_);
    sample.sigma_east_m = sample.sigma_north_m = std::max(errors_.gnss_position_sigma_m, 1e-3);
    sample.yaw = {pose_.yaw_rad + gnss_yaw_.next(time_s_, random_),
                  std::max(errors_.gnss_yaw_sigma_rad, 1e-4)};
    return sample;
  }

  /// The correction that a solver would find for the current pose from `prior`.
  SolverResult correction_from(const Se2& prior) {
    const Se2 error{errors_.correction_sigma_m * normal_(random_),
                    errors_.correction_sigma_m * normal_(random_),
                    errors_.correction_yaw_sigma_rad * normal_(random_)};
    SolverResult result;
    result.evidence = Evidence::kGood;
    result.correction = correction_between(prior, pose_ * error);
    const double position_sigma_m = std::max(errors_.correction_sigma_m, 0.01);
    const double yaw_sigma_rad = std::max(errors_.correction_yaw_sigma_rad, radians(0.05));
    result.covariance =
        Eigen::Vector3d(position_sigma_m, position_sigma_m, yaw_sigma_rad).cwiseAbs2().asDiagonal();
    return result;
  }

 private:
  SensorErrors errors_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  CorrelatedError gnss_x_;
  CorrelatedError gnss_y_;
  CorrelatedError gnss_yaw_;
  Se2 pose_{100.0, -50.0, 0.4};
  double time_s_ = 0.0;
};

/// Error of the tracked pose in the vehicle frame: (longitudinal m, lateral m, yaw rad).
inline Eigen::Vector3d error_of(const TrackedPose& tracked, const Se2& truth) {
  const Se2 error = correction_between(tracked.map_from_vehicle, truth);
  return {error.x_m, error.y_m, error.yaw_rad};
}

/// Normalised estimation error squared (NEES): 3 on average if the covariance is correct.
inline double nees_of(const TrackedPose& tracked, const Se2& truth) {
  const Eigen::Vector3d error = error_of(tracked, truth);
  return error.dot(tracked.covariance.ldlt().solve(error));
}

inline constexpr double kOdometryStep_s = 0.02;

/// Drives in steps of one odometry sample, with GNSS and corrections at their own rates.
struct Drive {
  int gnss_every = 10;       ///< in odometry samples; 0: only the first sample
  int correction_every = 0;  ///< in odometry samples; 0: never
  std::function<void(double time_s, const Se2& truth)> check = [](double, const Se2&) {};

  void run(Tracker& tracker, SimulatedVehicle& vehicle, double seconds) const {
    const int steps = static_cast<int>(seconds / kOdometryStep_s + 0.5);
    for (int i = 0; i <= steps; ++i) {
      const double time_s = i * kOdometryStep_s;
      const Se2 truth = vehicle.drive_to(time_s);
      EXPECT_EQ(tracker.add_odometry(vehicle.odometry(time_s)), TrackerUpdate::kAccepted);
      if (i == 0 || (gnss_every > 0 && i % gnss_every == 0)) tracker.add_gnss(vehicle.gnss());
      if (correction_every > 0 && i > 0 && i % correction_every == 0) {
        const Se2 prior = tracker.pose_at(at_s(time_s))->map_from_vehicle;
        tracker.add_correction(at_s(time_s), prior, vehicle.correction_from(prior));
      }
      check(time_s, truth);
    }
  }
};

inline SensorErrors typical_errors() {
  return {.speed_scale = 0.015,
          .yaw_rate_bias_radps = radians(0.25),
          .yaw_rate_sigma_radps = radians(0.1) / std::sqrt(kOdometryStep_s),
          .gnss_position_sigma_m = 1.0,
          .gnss_yaw_sigma_rad = radians(1.0),
          .gnss_correlation_s = 15.0,
          .correction_sigma_m = 0.1,
          .correction_yaw_sigma_rad = radians(0.2)};
}

}  // namespace bevloc
