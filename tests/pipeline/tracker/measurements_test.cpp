#include "pipeline/tracker/measurements.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

MatchResult match_with_sigma(const Eigen::Vector3d& sigma) {
  MatchResult match;
  match.evidence = Evidence::kGood;
  match.covariance = sigma.cwiseAbs2().asDiagonal();
  return match;
}

TEST(PoseSigma, IncludesWhatNoMatchSees) {
  MeasurementModel model;
  model.match_floor = {0.04, 0.12, 0.0};
  const Eigen::Vector3d sigma = pose_sigma(match_with_sigma({0.03, 0.05, 0.01}), model);
  EXPECT_NEAR(sigma.x(), 0.05, 1e-12);
  EXPECT_NEAR(sigma.y(), 0.13, 1e-12);
  EXPECT_NEAR(sigma.z(), 0.01, 1e-12);
}

// pose_sigma() states the same variance as the measurement that the filter gets.
TEST(PoseSigma, IsWhatTheFilterIsTold) {
  const MatchResult match = match_with_sigma({0.1, 0.05, radians(0.2)});
  const MeasurementModel model;
  const PoseMeasurement told =
      measurement_from(Se2{}, match, model, Eigen::Array<bool, 3, 1>::Constant(true));
  const Eigen::Vector3d variance = told.covariance.diagonal() + told.correlated_sigma.cwiseAbs2();
  EXPECT_TRUE(variance.cwiseSqrt().isApprox(pose_sigma(match, model), 1e-9))
      << variance.cwiseSqrt().transpose() << " and " << pose_sigma(match, model).transpose();
}

}  // namespace
}  // namespace bevloc
