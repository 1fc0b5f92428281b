// Bounds the error of the pose at a stated integrity risk.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace bevloc {

struct ProtectionParameters {
  /// Largest probability per pose and axis that the error exceeds the protection level.
  double integrity_risk = 1e-5;
  /// Factor on sigma: the tails of real errors are wider than those of a normal distribution.
  double tail_factor = 1.1;

  bool operator==(const ProtectionParameters&) const = default;
};

/// What GNSS says about the pose.
struct GnssView {
  /// GNSS minus pose along the vehicle's axes, in standard deviations: (along, across, yaw).
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  /// The standard deviations: (m, m, rad).
  Eigen::Vector3d sigma = Eigen::Vector3d::Ones();
  bool has_yaw = true;  ///< otherwise GNSS says nothing about the third axis
  bool sees(int axis) const { return axis < 2 || has_yaw; }
};

/// The protection level of each axis in the vehicle frame: (longitudinal m, lateral m, yaw rad).
///
/// There are two cases. If the match shows the right place, the error is as large as the estimate's
/// covariance says. If it shows a wrong place, the pose is as wrong as GNSS says. Bayes' rule gives
/// the odds of a wrong place as a product of three factors: the rate of wrong places, the time
/// `exposure_s` in which GNSS could not show one, and the likelihood ratio of the GNSS error (wrong
/// to right place). The level is the quantile of the mixture. Without GNSS, a wrong place may be
/// anywhere.
/// Source: the multiple-hypothesis solution separation of aviation (ARAIM).
Eigen::Vector3d protection_level(const Eigen::Vector3d& sigma, const std::optional<GnssView>& gnss,
                                 double exposure_s, const ProtectionParameters& parameters);

}  // namespace bevloc
