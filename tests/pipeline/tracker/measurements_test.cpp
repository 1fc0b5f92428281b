#include "pipeline/tracker/measurements.h"

#include <cmath>

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

// On a straight road the match sees nothing along it. A small correction of the heading must not
// turn that uncertainty into the axis across the road.
TEST(MatchMeasurement, AnUnseenAxisDoesNotMakeAnotherUncertain) {
  MatchResult match = match_with_sigma({1.5, 0.05, radians(0.15)});
  match.evidence_share = {0.0, 1.0, 1.0};
  match.correction = {0.1, 0.1, radians(0.5)};
  const Se2 prior{100.0, 50.0, radians(70.0)};
  const PoseMeasurement told =
      measurement_from(prior, match, {}, Eigen::Array<bool, 3, 1>::Constant(true));
  EXPECT_GT(std::sqrt(told.covariance(0, 0)), 100.0);
  EXPECT_LT(std::sqrt(told.covariance(1, 1)), 0.05);
  EXPECT_GT(told.uncommon_variance.x(), 0.0);
  EXPECT_EQ(told.uncommon_variance.y(), 0.0);

  // Near the place of the match, an estimate that knows nothing learns the position across.
  FilterState state;
  state.map_from_vehicle = prior * Se2{0.0, 0.2, radians(0.1)};
  state.covariance.topLeftCorner<3, 3>() = Eigen::Vector3d(0.5, 0.5, 0.1).cwiseAbs2().asDiagonal();
  update(told, state);
  EXPECT_LT(std::sqrt(state.covariance(1, 1)), 0.12);
  EXPECT_NEAR(std::sqrt(state.covariance(0, 0)), 0.5, 0.01);
}

}  // namespace
}  // namespace bevloc
