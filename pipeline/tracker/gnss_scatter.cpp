#include "pipeline/tracker/gnss_scatter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pipeline/tracker/gnss_pose.h"
#include "pipeline/tracker/motion_model.h"

namespace bevloc {
namespace {

/// Weight of a new sample in the mean.
constexpr double kScatterGain = 0.05;
/// A sample counts as at most this multiple of the mean, so that a jump is not taken for noise.
constexpr double kMostOfMean = 4.0;
/// The mean of samples with the right sigma stays below 1 plus this.
constexpr double kUsualExcess = 0.5;
/// If the factor exceeds kWrongFactor, the receiver's own sigma counts as wrong, until the factor
/// falls below kFactorNoLongerWrong.
constexpr double kWrongFactor = 2.0;
constexpr double kFactorNoLongerWrong = 1.5;
/// Samples with a longer pause between them are not compared.
constexpr double kLongestPause_s = 2.0;
/// Noise of dead reckoning between two samples: 1 sigma of position and yaw.
constexpr double kMotionNoise_m = 0.03;
constexpr double kMotionNoise_rad = radians(0.05);

/// The middle sample is compared with the mean of its neighbours, weighted by time.
struct Weights {
  double first = 0.5;
  double last = 0.5;
  /// Variance of the difference between them if each sample has a variance of 1: for independent
  /// errors, and for errors that change slowly.
  double of_noise = 1.5;
  double of_correlated = 0.0;
};

Weights weights_of(double first_s, double last_s, double correlation_s) {
  const auto alike = [correlation_s](double apart_s) { return kept_share(apart_s, correlation_s); };
  Weights weights;
  weights.last = first_s / (first_s + last_s);
  weights.first = 1.0 - weights.last;
  weights.of_noise = 1.0 + square_of(weights.first) + square_of(weights.last);
  weights.of_correlated = weights.of_noise - 2.0 * weights.first * alike(first_s) -
                          2.0 * weights.last * alike(last_s) +
                          2.0 * weights.first * weights.last * alike(first_s + last_s);
  return weights;
}

}  // namespace

void GnssScatter::Ratio::add(double squared) {
  mean_ += kScatterGain * (std::min(squared, kMostOfMean * mean_) - mean_);
  mean_ = std::max(mean_, 1.0);
}

double GnssScatter::Ratio::factor() const {
  return std::sqrt(std::max(mean_ - kUsualExcess, 1.0));
}

void GnssScatter::add(const OdometrySample& sample) {
  if (odometry_) start_from_vehicle_ = start_from_vehicle_at(sample.time);
  odometry_ = sample;
}

Se2 GnssScatter::start_from_vehicle_at(Time time) const {
  const double elapsed_s = to_seconds(time - odometry_->time);
  return start_from_vehicle_ *
         arc_motion(odometry_->speed_mps, odometry_->yaw_rate_radps, elapsed_s);
}

void GnssScatter::add(const GnssSample& sample, double yaw_rad) {
  if (!odometry_) return;
  if (known_ > 0) {
    const double pause_s = to_seconds(sample.time - records_[known_ - 1].sample.time);
    if (pause_s <= 0.0) return;
    if (pause_s > kLongestPause_s) forget_samples();
  }
  if (known_ == records_.size()) {
    std::rotate(records_.begin(), records_.begin() + 1, records_.end());
    --known_;
  }
  records_[known_++] = {sample, start_from_vehicle_at(sample.time), yaw_rad};
  if (known_ == records_.size()) compare_middle();
}

void GnssScatter::compare_middle() {
  const Record& first = records_[0];
  const Record& middle = records_[1];
  const Record& last = records_[2];
  const Weights weights =
      weights_of(to_seconds(middle.sample.time - first.sample.time),
                 to_seconds(last.sample.time - middle.sample.time), correlation_s_);
  const PoseMeasurement claimed =
      measurement_from(gnss_pose(middle.sample), model_, correlation_s_ > 0.0);
  const auto expected = [&claimed, &weights](Eigen::Index axis, double motion_sigma) {
    return weights.of_noise * claimed.covariance(axis, axis) +
           weights.of_correlated * square_of(claimed.correlated_sigma(axis)) +
           square_of(motion_sigma);
  };
  // The place where the middle sample should lie according to one of its neighbours.
  const auto position_from = [&middle](const Record& from) -> Eigen::Vector2d {
    const Se2 motion = correction_between(from.start_from_vehicle, middle.start_from_vehicle);
    const double yaw_rad = middle.yaw_rad - motion.yaw_rad;
    return Eigen::Vector2d(from.sample.east_m, from.sample.north_m) +
           Eigen::Rotation2Dd(yaw_rad) * motion.translation();
  };
  const Eigen::Vector2d error = Eigen::Vector2d(middle.sample.east_m, middle.sample.north_m) -
                                weights.first * position_from(first) -
                                weights.last * position_from(last);
  position_.add(0.5 * error.squaredNorm() / expected(0, kMotionNoise_m));

  if (first.sample.yaw && middle.sample.yaw && last.sample.yaw) {
    const auto turn_from = [&middle](const Record& from) {
      const double motion_rad = middle.start_from_vehicle.yaw_rad - from.start_from_vehicle.yaw_rad;
      return wrap_angle(middle.sample.yaw->yaw_rad - from.sample.yaw->yaw_rad - motion_rad);
    };
    const double error_rad = weights.first * turn_from(first) + weights.last * turn_from(last);
    yaw_.add(square_of(error_rad) / expected(2, kMotionNoise_rad));
  }
  const double limit = contradicts_ ? kFactorNoLongerWrong : kWrongFactor;
  contradicts_ = std::max(position_.factor(), yaw_.factor()) > limit;
}

GnssSample GnssScatter::with_seen_sigma(GnssSample sample) const {
  const auto grow = [](double& sigma, double least, double factor) {
    if (factor > 1.0 && sigma > 0.0) sigma = std::max(sigma, least) * factor;
  };
  grow(sample.sigma_east_m, model_.gnss_min_position_sigma_m, position_.factor());
  grow(sample.sigma_north_m, model_.gnss_min_position_sigma_m, position_.factor());
  if (sample.yaw) grow(sample.yaw->sigma_rad, model_.gnss_min_yaw_sigma_rad, yaw_.factor());
  return sample;
}

}  // namespace bevloc
