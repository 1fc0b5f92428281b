// Finds a constant offset between map and GNSS.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "common/time.h"

namespace bevloc {

/// The matched pose is as wrong as the map. GNSS errors come and go within their correlation time,
/// but a map that was surveyed in another datum, or moved, lies off by the same vector all the
/// time. A Kalman filter splits the difference of GNSS and pose into this constant offset and the
/// error of GNSS, a first-order Gauss-Markov process. A constant error of the receiver, such as of
/// the place of its antenna, looks the same. From the start on it takes up to four minutes to find
/// 3 m, and up to an hour to find 1 m. An offset of 3 m that begins after an hour on a right map is
/// found after up to 20 minutes.
///
/// One thread. Does not allocate.
class MapOffsetMonitor {
 public:
  /// `correlation_s` is the time constant of GNSS errors.
  explicit MapOffsetMonitor(double correlation_s) : correlation_s_(correlation_s) {}

  /// `difference_m` is GNSS minus pose along the axes of the map. `sigma_m` is the sigma of GNSS
  /// per axis. Uses at most one sample per second. Ignores a sample that is too far from what the
  /// filter expects, such as after a jump of GNSS, unless all samples have been so for several
  /// minutes.
  void add(Time time, const Eigen::Vector2d& difference_m, double sigma_m);

  /// Becomes true when the offset is certain and more than 0.75 m. Stays true until the estimated
  /// offset is 0.5 m or less.
  bool contradicts() const { return contradicts_; }

  /// GNSS minus map.
  const Eigen::Vector2d& offset_m() const { return offset_m_; }

 private:
  void predict(double elapsed_s, double sigma_m);
  void note_outlier();
  void judge();

  double correlation_s_;
  std::optional<Time> latest_;
  int outliers_in_a_row_ = 0;
  Eigen::Vector2d offset_m_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d error_m_ = Eigen::Vector2d::Zero();  ///< error of GNSS
  // The covariance of offset and error, which is the same for both axes of the map.
  double offset_variance_ = 0.0;
  double error_variance_ = 0.0;
  double common_variance_ = 0.0;
  bool contradicts_ = false;
};

}  // namespace bevloc
