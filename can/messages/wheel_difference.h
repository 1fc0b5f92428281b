// Compares the difference of the wheel speeds with the yaw rate.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <boost/circular_buffer.hpp>

#include "common/time.h"

namespace bevloc::can {

/// Limits of WheelDifference. The wheels of a real vehicle differ by more than yaw rate times
/// track, because radii, track and the zero of the yaw rate are not exactly known. These errors are
/// constant for minutes, so they are learned. A change within a second is a fault.
struct WheelDifferenceLimits {
  // The errors (1 sigma) that are assumed before anything was learned.
  double radius_share = 0.01;  ///< share of the speed: tyres of different wear or pressure
  double zero_mps = 0.015;     ///< zero of the yaw rate, times the track
  double track_m = 0.1;        ///< error of the track
  double noise_mps = 0.06;     ///< noise of one sample
  double memory_s = 60.0;      ///< older samples count less

  /// By how much the mean of about the last 0.3 s may deviate from what was learned: the sum of a
  /// constant, a share of the speed, and a time multiplied by the lateral acceleration, which moves
  /// load between the tyres.
  double change_mps = 0.05;
  double change_share = 0.001;
  double change_per_mps2_s = 0.005;
  double mean_s = 0.3;
  /// In addition, this many standard deviations of the learned value are permitted.
  double sigmas = 3.0;
  /// The time over which lean() takes its mean.
  double lean_mean_s = 0.8;
  double lean_most_sigma_mps = 0.014;  ///< 0.5 degrees/s times the track
  /// A contradiction ends when the mean is below this share of the limit.
  double ends_below = 0.6;
  /// Samples are learned this much later, and only if there was no contradiction until then, so
  /// that the beginning of a fault is not learned.
  Duration learned_after = std::chrono::seconds(1);

  /// A contradiction that lasts this long is a lasting change. Then everything is learned again.
  Duration settled_after = std::chrono::seconds(60);
  /// The mean begins again after a longer pause than this.
  Duration gap = std::chrono::milliseconds(500);
};

/// Learns by recursive least squares how the wheels differ beyond what the yaw rate explains:
/// radius error * speed + zero + track error * yaw rate. One thread. Allocates in its constructor
/// only.
class WheelDifference {
 public:
  struct Sample {
    Time time{};
    double excess_mps = 0.0;  ///< right minus left wheel, minus yaw rate times track
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
  };

  explicit WheelDifference(const WheelDifferenceLimits& limits) : limits_(limits) {}

  /// Adds a sample. Returns whether the mean deviates from what was learned by more than the limit.
  bool contradicts(const Sample& sample);

  /// The mean of about the last second beyond what was learned, in its standard deviations. It
  /// shows a smaller change than contradicts(), but not reliably enough to refuse samples. It is
  /// empty while the standard deviation exceeds `lean_most_sigma_mps`.
  std::optional<double> lean() const { return lean_; }

 private:
  void update_lean(double excess_mps, double elapsed_s, const Sample& sample, double fit_sigma_mps);
  void learn_late(const Sample& sample);
  void learn(const Sample& sample);
  void forget_all();
  Eigen::Matrix3d information() const;

  /// Holds WheelDifferenceLimits::learned_after of odometry at 250 Hz.
  static constexpr size_t kMostWaiting = 256;

  WheelDifferenceLimits limits_;
  /// Sums of the fit, in which older samples count less.
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  boost::circular_buffer<Sample> waiting_{kMostWaiting};  ///< samples to be learned, oldest first
  double mean_mps_ = 0.0;       ///< mean of the recent excess beyond the fit
  double slow_mean_mps_ = 0.0;  ///< the same over a longer time, for lean()
  std::optional<double> lean_;
  std::optional<Time> latest_;
  std::optional<Time> learned_until_;
  std::optional<Time> contradicting_since_;
};

}  // namespace bevloc::can
