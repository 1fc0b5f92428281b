// Compares the difference of the wheel speeds with the yaw rate.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <boost/circular_buffer.hpp>

#include "common/time.h"

namespace bevloc::can {

/// Learns by recursive least squares how the wheels differ beyond what the yaw rate explains:
/// radius error * speed + zero + track error * yaw rate. The wheels of a real vehicle differ by
/// more than yaw rate times track, because radii, track and the zero of the yaw rate are not
/// exactly known. These errors are constant for minutes, so they are learned. A change within a
/// second is a fault. One thread. Allocates in its constructor only.
class WheelDifference {
 public:
  struct Sample {
    Time time{};
    double excess_mps = 0.0;  ///< right minus left wheel, minus yaw rate times track
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
  };

  /// Adds a sample. Returns whether the mean deviates from what was learned by more than the limit.
  bool contradicts(const Sample& sample);

  /// By how much the mean of about the last second deviates from what was learned, in units of its
  /// standard deviation. It shows smaller changes than contradicts() does, but not reliably enough
  /// to refuse samples. It is empty while the standard deviation exceeds 0.5 degrees/s times the
  /// track.
  std::optional<double> lean() const { return lean_; }

 private:
  void update_lean(double excess_mps, double elapsed_s, const Sample& sample, double fit_sigma_mps);
  void learn_late(const Sample& sample);
  void learn(const Sample& sample);
  void forget_all();
  Eigen::Matrix3d information() const;

  /// Holds the second of odometry that is not learned yet, at 250 Hz.
  static constexpr size_t kMostWaiting = 256;

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
