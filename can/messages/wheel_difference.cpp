#include "can/messages/wheel_difference.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace bevloc::can {

namespace {

Eigen::Vector3d inputs_of(const WheelDifference::Sample& sample) {
  return {sample.speed_mps, 1.0, sample.yaw_rate_radps};
}

/// How far the difference of real wheels may change with the speed and in bends.
double change_with_motion(const WheelDifference::Sample& sample,
                          const WheelDifferenceLimits& limits) {
  return limits.change_share * std::abs(sample.speed_mps) +
         limits.change_per_mps2_s * std::abs(sample.speed_mps * sample.yaw_rate_radps);
}

}  // namespace

bool WheelDifference::contradicts(const Sample& sample) {
  if (latest_ && sample.time - *latest_ > limits_.gap) mean_mps_ = slow_mean_mps_ = 0.0;
  const double elapsed_s =
      latest_ ? std::clamp(to_seconds(sample.time - *latest_), 0.0, limits_.mean_s) : 0.0;
  latest_ = sample.time;

  const Eigen::Vector3d inputs = inputs_of(sample);
  const Eigen::LLT<Eigen::Matrix3d> information(this->information());
  const double expected_mps = inputs.dot(information.solve(right_));
  const double sigma_mps = limits_.noise_mps * std::sqrt(inputs.dot(information.solve(inputs)));
  const double allowed_mps =
      limits_.change_mps + change_with_motion(sample, limits_) + limits_.sigmas * sigma_mps;
  const double gain = 1.0 - std::exp(-elapsed_s / limits_.mean_s);
  mean_mps_ += gain * (sample.excess_mps - expected_mps - mean_mps_);
  update_lean(sample.excess_mps - expected_mps, elapsed_s, sample, sigma_mps);

  const double share = contradicting_since_ ? limits_.ends_below : 1.0;
  if (std::abs(mean_mps_) <= share * allowed_mps) {
    contradicting_since_.reset();
    learn_late(sample);
    return false;
  }
  waiting_.clear();
  if (!contradicting_since_) contradicting_since_ = sample.time;
  if (sample.time - *contradicting_since_ >= limits_.settled_after) forget_all();
  return true;
}

void WheelDifference::update_lean(double excess_mps, double elapsed_s, const Sample& sample,
                                  double fit_sigma_mps) {
  const double gain = 1.0 - std::exp(-elapsed_s / limits_.lean_mean_s);
  if (gain <= 0.0) return;
  slow_mean_mps_ += gain * (excess_mps - slow_mean_mps_);
  const double noise_mps = limits_.noise_mps * std::sqrt(gain / (2.0 - gain));
  // The permitted change counts as three standard deviations.
  const double change_mps = change_with_motion(sample, limits_) / 3.0;
  const double sigma_mps = std::hypot(noise_mps, change_mps, fit_sigma_mps);
  lean_.reset();
  if (sigma_mps <= limits_.lean_most_sigma_mps) lean_ = slow_mean_mps_ / sigma_mps;
}

/// The information matrix of the fit, including the prior knowledge before anything was learned.
Eigen::Matrix3d WheelDifference::information() const {
  const Eigen::Array3d sigmas(limits_.radius_share, limits_.zero_mps, limits_.track_m);
  Eigen::Matrix3d information = normal_;
  information.diagonal().array() += (limits_.noise_mps / sigmas).square();
  return information;
}

void WheelDifference::learn_late(const Sample& sample) {
  const Time until = sample.time - limits_.learned_after;
  while (!waiting_.empty() && (waiting_.front().time <= until || waiting_.full())) {
    learn(waiting_.front());
    waiting_.pop_front();
  }
  waiting_.push_back(sample);
}

void WheelDifference::learn(const Sample& sample) {
  const Eigen::Vector3d inputs = inputs_of(sample);
  const double elapsed_s = learned_until_ ? to_seconds(sample.time - *learned_until_) : 0.0;
  learned_until_ = sample.time;
  const double kept = std::exp(-elapsed_s / limits_.memory_s);
  normal_ = kept * normal_ + inputs * inputs.transpose();
  right_ = kept * right_ + inputs * sample.excess_mps;
}

void WheelDifference::forget_all() {
  normal_.setZero();
  right_.setZero();
  mean_mps_ = 0.0;
  slow_mean_mps_ = 0.0;
  contradicting_since_.reset();
}

}  // namespace bevloc::can
