// An arbiter with a match and a GNSS sample every 0.1 s.
#pragma once

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "pipeline/tracker/arbiter.h"

namespace bevloc::test {

inline const double kYawSigma_rad = std::sqrt(2e-5);

inline PoseInnovation innovation(const Eigen::Vector3d& error) {
  PoseInnovation result;
  result.error = error;
  result.covariance = Eigen::Vector3d(0.09, 0.04, kYawSigma_rad * kYawSigma_rad).asDiagonal();
  result.squared_distance = error.dot(result.covariance.inverse() * error);
  result.unexplained = result.squared_distance;
  return result;
}

/// A pose that is valid, with a match and a GNSS sample every 0.1 s.
class ArbiterTest : public testing::Test {
 protected:
  static constexpr double kGate = 16.27;

  Verdict step(const PoseInnovation& match, const PoseInnovation& gnss,
               const Eigen::Vector3d& gnss_error, PoseStanding standing = PoseStanding::kValid) {
    now_ += std::chrono::milliseconds(100);
    arbiter_.add_match(now_, match, match.squared_distance < kGate);
    arbiter_.add_gnss(now_, gnss, gnss.squared_distance < kGate, GnssError{gnss_error, yaw_rad_});
    return arbiter_.judge(now_, standing);
  }

  Verdict run(int samples, const Eigen::Vector3d& match_error, const Eigen::Vector3d& gnss_offset) {
    Verdict verdict;
    for (int i = 0; i < samples; ++i) {
      verdict = step(innovation(match_error), innovation(gnss_offset), none_);
    }
    return verdict;
  }

  /// Adds matches and GNSS samples without innovation, while the error of GNSS is `gnss_error`.
  void run_with_gnss_error(int samples, double gnss_error) {
    for (int i = 0; i < samples; ++i) {
      step(innovation(none_), innovation(none_), {gnss_error, 0.0, 0.0});
    }
  }

  const Eigen::Vector3d none_ = Eigen::Vector3d::Zero();
  double yaw_rad_ = 0.0;
  Arbiter arbiter_{40.0};
  Time now_{std::chrono::seconds(100)};
};

}  // namespace bevloc::test
