#include "pipeline/tracker/protection_level.h"

#include <gtest/gtest.h>

#include "common/se2.h"

namespace bevloc {
namespace {

const Eigen::Vector3d kSigma{0.2, 0.1, radians(0.2)};
const Eigen::Vector3d kGnssSigma{1.0, 1.0, radians(1.0)};

TEST(ProtectionLevelTest, IsTheQuantileOfANormalErrorWhileGnssAgrees) {
  for (const double tail_factor : {1.0, ProtectionParameters().tail_factor, 1.5}) {
    ProtectionParameters parameters;
    parameters.tail_factor = tail_factor;
    const Eigen::Vector3d level =
        protection_level(kSigma, GnssView{Eigen::Vector3d::Zero(), kGnssSigma}, 40.0, parameters);
    for (int axis = 0; axis < 3; ++axis) {
      // Two-sided quantile of the standard normal distribution at 1e-5, from a table.
      EXPECT_NEAR(level(axis) / kSigma(axis), 4.417 * tail_factor, 0.01) << "axis " << axis;
    }
  }
}

TEST(ProtectionLevelTest, GrowsWhereGnssPointsElsewhere) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto level_at = [axis](double error) {
      const Eigen::Vector3d errors = error * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector3d level =
          protection_level(kSigma, GnssView{errors, kGnssSigma}, 40.0, {});
      return level(axis) / kGnssSigma(axis);
    };
    EXPECT_NEAR(level_at(2.0), level_at(0.0), 0.05) << "axis " << axis;
    EXPECT_GT(level_at(4.4), 3.0) << "axis " << axis << ", GNSS says 4.4 sigmas elsewhere";
    EXPECT_NEAR(level_at(-4.4), level_at(4.4), 0.01) << "axis " << axis;
  }
}

/// The error of the heading is then that of the start, and says nothing about this moment.
TEST(ProtectionLevelTest, GnssWithoutAHeadingSaysNothingAboutTheHeading) {
  const Eigen::Vector3d sigma{1.0, 1.0, M_PI};
  const GnssView without{{0.0, 0.0, 2.9}, sigma, false};
  const Eigen::Vector3d level = protection_level(kSigma, without, 40.0, {});
  const Eigen::Vector3d agreeing =
      protection_level(kSigma, GnssView{Eigen::Vector3d::Zero(), kGnssSigma}, 40.0, {});
  EXPECT_NEAR(level.y(), agreeing.y(), 0.01);
  EXPECT_LT(level.z(), radians(2.0));
}

TEST(ProtectionLevelTest, GrowsWithTheTimeWithoutGnss) {
  const double soon = protection_level(kSigma, std::nullopt, 60.0, {}).y();
  const double late = protection_level(kSigma, std::nullopt, 1e5, {}).y();
  EXPECT_LT(soon, 0.6);
  EXPECT_GT(late, 2.0);
}

TEST(ProtectionLevelTest, FollowsTheIntegrityRisk) {
  ProtectionParameters strict;
  strict.integrity_risk = 1e-7;
  const GnssView view{Eigen::Vector3d::Zero(), kGnssSigma};
  EXPECT_GT(protection_level(kSigma, view, 40.0, strict).y(),
            1.1 * protection_level(kSigma, view, 40.0, {}).y());
}

}  // namespace
}  // namespace bevloc
