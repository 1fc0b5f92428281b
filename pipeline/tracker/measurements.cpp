#include "pipeline/tracker/measurements.h"

#include <algorithm>

namespace bevloc {
namespace {

/// Lower bound of the evidence share. It keeps the covariance finite along an axis without
/// evidence: sigma grows by a factor of 100 at most.
constexpr double kMinEvidenceShare = 1e-4;

constexpr double kUnknownYaw_rad = 1e3;

/// Covariance of the match alone. The solver's covariance includes its own prior, a uniform
/// distribution over the search range, which the filter replaces by its estimate. If all were
/// Gaussian, the precision along an axis without that prior would be
/// 1 / variance - 1 / (variance of the range) = share / variance. With the prior left in, a search
/// without evidence along the road would confirm its own starting pose again and again.
Eigen::Matrix3d covariance_of_match(const MatchResult& result) {
  const Eigen::Vector3d growth =
      result.evidence_share.cwiseMax(kMinEvidenceShare).cwiseInverse().cwiseSqrt();
  return growth.asDiagonal() * result.covariance * growth.asDiagonal();
}

}  // namespace

PoseMeasurement measurement_from(const GnssPose& gnss, const MeasurementModel& model,
                                 bool correlated) {
  const double position_sigma_m = std::max(gnss.position_sigma_m, model.gnss_min_position_sigma_m);
  const double yaw_sigma_rad = std::max(gnss.yaw_sigma_rad, model.gnss_min_yaw_sigma_rad);
  const double share = correlated ? model.gnss_correlated_share : 0.0;
  const Eigen::Vector3d sigma(position_sigma_m, position_sigma_m, yaw_sigma_rad);
  PoseMeasurement measurement;
  measurement.source = PoseSource::kGnss;
  measurement.map_from_vehicle = gnss.map_from_vehicle;
  measurement.map_from_vehicle.yaw_rad = wrap_angle(gnss.map_from_vehicle.yaw_rad);
  measurement.covariance = ((1.0 - share) * sigma.cwiseAbs2()).asDiagonal();
  measurement.correlated_sigma = std::sqrt(share) * sigma;
  if (!gnss.has_yaw) {
    measurement.covariance(2, 2) = square_of(kUnknownYaw_rad);
    measurement.correlated_sigma.z() = 0.0;
  }
  return measurement;
}

Eigen::Vector3d pose_sigma(const MatchResult& result, const MeasurementModel& model) {
  return (result.covariance.diagonal().cwiseMax(0.0) + model.match_floor.cwiseAbs2()).cwiseSqrt();
}

PoseMeasurement measurement_from(const Se2& prior, const MatchResult& result,
                                 const MeasurementModel& model,
                                 const Eigen::Array<bool, 3, 1>& correlated) {
  const Eigen::Matrix3d covariance = covariance_of_match(result);
  const Eigen::Vector3d used = correlated.cast<double>();
  const Eigen::Vector3d share = model.match_correlated_share.cwiseProduct(used);
  const Eigen::Vector3d noise_scale = (Eigen::Vector3d::Ones() - share).cwiseSqrt();
  const Eigen::Vector3d alike = share.cwiseProduct(covariance.diagonal());
  const Eigen::Vector3d common = alike.cwiseMin(model.match_common_sigma.cwiseAbs2());
  const Eigen::Vector3d floor = model.match_floor.cwiseProduct(used);
  PoseMeasurement measurement;
  measurement.source = PoseSource::kMatch;
  measurement.map_from_vehicle = prior * result.correction;
  measurement.axes_yaw_rad = prior.yaw_rad;
  measurement.covariance = noise_scale.asDiagonal() * covariance * noise_scale.asDiagonal();
  measurement.uncommon_variance = alike - common;
  measurement.covariance.diagonal() += measurement.uncommon_variance;
  measurement.correlated_sigma = (common + floor.cwiseAbs2()).cwiseSqrt();
  return measurement;
}

}  // namespace bevloc
