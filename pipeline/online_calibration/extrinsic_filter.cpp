#include "pipeline/online_calibration/extrinsic_filter.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace bevloc {
namespace {

/// Divides the information of one match. Errors of the match are alike from cell to cell and from
/// frameset to frameset, so it counts much less than its sums say. The value was found on drives of
/// the development seeds: with it, the errors of the estimates agree with their sigmas.
constexpr double kNoise = 200.0;
constexpr double kSecondsPerHour = 3600.0;

// How large errors are and how fast they change, one sigma.
/// Rotation of one camera about each of its axes.
constexpr double kCameraRotation_rad = radians(0.3);
/// Shift of one camera along each of the vehicle's axes.
constexpr double kCameraShift_m = 0.02;
/// Rotation of all cameras together about the vehicle's axes. The load turns the body about x and
/// y.
const Eigen::Vector3d kBodyRotation_rad{radians(0.2), radians(0.2), radians(0.1)};
/// Growth after one hour of driving, of each angle and of each length.
constexpr double kGrowth_rad_per_sqrt_hour = radians(0.2);
constexpr double kGrowth_m_per_sqrt_hour = 0.005;

}  // namespace

ExtrinsicFilter::ExtrinsicFilter(const Rig& rig) {
  covariance_.setZero();
  Eigen::Matrix<double, kExtrinsicErrors, 3> body;
  body.setZero();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const int first = camera * kErrorsPerCamera;
    covariance_.diagonal().segment<3>(first).setConstant(kCameraRotation_rad * kCameraRotation_rad);
    covariance_.diagonal().segment<3>(first + 3).setConstant(kCameraShift_m * kCameraShift_m);
    heading_.segment<3>(first) =
        rig.cameras[camera].vehicle_from_camera.rotation.row(2).transpose() / kCameraCount;
    body.middleRows<3>(first) = rig.cameras[camera].vehicle_from_camera.rotation.transpose();
  }
  covariance_ += body * kBodyRotation_rad.cwiseAbs2().asDiagonal() * body.transpose();
}

bool ExtrinsicFilter::restore(const ExtrinsicErrors& errors,
                              const ExtrinsicCovariance& covariance) {
  if (!errors.allFinite() || !covariance.allFinite()) return false;
  const ExtrinsicCovariance symmetric = 0.5 * (covariance + covariance.transpose());
  if (Eigen::LLT<ExtrinsicCovariance>(symmetric).info() != Eigen::Success) return false;
  errors_ = errors;
  covariance_ = symmetric;
  return true;
}

void ExtrinsicFilter::update(const ExtrinsicInformation& match, const ExtrinsicErrors& used,
                             double driven_s) {
  const double hours = driven_s / kSecondsPerHour;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const int first = camera * kErrorsPerCamera;
    covariance_.diagonal().segment<3>(first).array() +=
        hours * kGrowth_rad_per_sqrt_hour * kGrowth_rad_per_sqrt_hour;
    covariance_.diagonal().segment<3>(first + 3).array() +=
        hours * kGrowth_m_per_sqrt_hour * kGrowth_m_per_sqrt_hour;
  }
  // P' = (P^-1 + A)^-1 = (I + P A)^-1 P, e' = e + P' (slope - A (e - used)).
  const ExtrinsicCovariance information = match.information / kNoise;
  ExtrinsicCovariance growth = covariance_ * information;
  growth.diagonal().array() += 1.0;
  const ExtrinsicCovariance posterior = growth.partialPivLu().solve(covariance_);
  covariance_ = 0.5 * (posterior + posterior.transpose());
  const ExtrinsicErrors slope = match.slope / kNoise - information * (errors_ - used);
  errors_ += covariance_ * slope;
}

void ExtrinsicFilter::update_heading(const HeadingTurn& turn) {
  const ExtrinsicErrors gain = covariance_ * heading_;
  const double variance = heading_.dot(gain) + turn.variance;
  errors_ += gain * ((turn.turn_rad - turn_by(errors_)) / variance);
  covariance_ -= gain * gain.transpose() / variance;
}

}  // namespace bevloc
