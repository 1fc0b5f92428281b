#include "can/messages/wheel_difference.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace bevloc::can {
namespace {

// The errors (1 sigma) that are assumed before anything was learned.
constexpr double kRadiusShare = 0.01;  ///< share of the speed: tyres of different wear or pressure
constexpr double kZero_mps = 0.015;    ///< zero of the yaw rate, times the track
constexpr double kTrackError_m = 0.1;
constexpr double kNoise_mps = 0.06;  ///< noise of one sample
constexpr double kMemory_s = 60.0;   ///< older samples count less

// By how much the mean of about the last 0.3 s may deviate from what was learned: the sum of a
// constant, a share of the speed, and a time multiplied by the lateral acceleration, which moves
// load between the tyres.
constexpr double kChange_mps = 0.05;
constexpr double kChangeShare = 0.001;
constexpr double kChangePerMps2_s = 0.005;
constexpr double kMean_s = 0.3;
/// In addition, this many standard deviations of the learned value are permitted.
constexpr double kSigmas = 3.0;
/// The time over which lean() takes its mean.
constexpr double kLeanMean_s = 0.8;
constexpr double kLeanMostSigma_mps = 0.014;  ///< 0.5 degrees/s times the track
/// A contradiction ends when the mean is below this share of the limit.
constexpr double kEndsBelow = 0.6;
/// Samples are learned this much later, and only if there was no contradiction until then, so that
/// the beginning of a fault is not learned.
constexpr Duration kLearnedAfter = std::chrono::seconds(1);

/// A contradiction that lasts this long is a lasting change. Then everything is learned again.
constexpr Duration kLastingChange = std::chrono::seconds(60);
/// The mean begins again after a longer pause than this.
constexpr Duration kGap = std::chrono::milliseconds(500);

Eigen::Vector3d inputs_of(const WheelDifference::Sample& sample) {
  return {sample.speed_mps, 1.0, sample.yaw_rate_radps};
}

/// How far the difference of real wheels may change with the speed and in bends.
double change_with_motion(const WheelDifference::Sample& sample) {
  return kChangeShare * std::abs(sample.speed_mps) +
         kChangePerMps2_s * std::abs(sample.speed_mps * sample.yaw_rate_radps);
}

}  // namespace

bool WheelDifference::contradicts(const Sample& sample) {
  if (latest_ && sample.time - *latest_ > kGap) mean_mps_ = slow_mean_mps_ = 0.0;
  const double elapsed_s =
      latest_ ? std::clamp(to_seconds(sample.time - *latest_), 0.0, kMean_s) : 0.0;
  latest_ = sample.time;

  const Eigen::Vector3d inputs = inputs_of(sample);
  const Eigen::LLT<Eigen::Matrix3d> information(this->information());
  const double expected_mps = inputs.dot(information.solve(right_));
  const double sigma_mps = kNoise_mps * std::sqrt(inputs.dot(information.solve(inputs)));
  const double allowed_mps = kChange_mps + change_with_motion(sample) + kSigmas * sigma_mps;
  const double gain = 1.0 - std::exp(-elapsed_s / kMean_s);
  mean_mps_ += gain * (sample.excess_mps - expected_mps - mean_mps_);
  update_lean(sample.excess_mps - expected_mps, elapsed_s, sample, sigma_mps);

  const double share = contradicting_since_ ? kEndsBelow : 1.0;
  if (std::abs(mean_mps_) <= share * allowed_mps) {
    contradicting_since_.reset();
    learn_late(sample);
    return false;
  }
  waiting_.clear();
  if (!contradicting_since_) contradicting_since_ = sample.time;
  if (sample.time - *contradicting_since_ >= kLastingChange) forget_all();
  return true;
}

void WheelDifference::update_lean(double excess_mps, double elapsed_s, const Sample& sample,
                                  double fit_sigma_mps) {
  const double gain = 1.0 - std::exp(-elapsed_s / kLeanMean_s);
  if (gain <= 0.0) return;
  slow_mean_mps_ += gain * (excess_mps - slow_mean_mps_);
  const double noise_mps = kNoise_mps * std::sqrt(gain / (2.0 - gain));
  // The permitted change counts as three standard deviations.
  const double change_mps = change_with_motion(sample) / 3.0;
  const double sigma_mps = std::hypot(noise_mps, change_mps, fit_sigma_mps);
  lean_.reset();
  if (sigma_mps <= kLeanMostSigma_mps) lean_ = slow_mean_mps_ / sigma_mps;
}

/// The information matrix of the fit, including the prior knowledge before anything was learned.
Eigen::Matrix3d WheelDifference::information() const {
  const Eigen::Array3d sigmas(kRadiusShare, kZero_mps, kTrackError_m);
  Eigen::Matrix3d information = normal_;
  information.diagonal().array() += (kNoise_mps / sigmas).square();
  return information;
}

void WheelDifference::learn_late(const Sample& sample) {
  const Time until = sample.time - kLearnedAfter;
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
  const double kept = std::exp(-elapsed_s / kMemory_s);
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
