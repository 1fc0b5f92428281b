#include "pipeline/tracker/match_repetition.h"

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

constexpr MeasuredMotion kDriving{10.0, 0.0};
constexpr MeasuredMotion kStanding{0.0, 0.0};

class MatchRepetitionTest : public testing::Test {
 protected:
  /// The variance that is added to a match at this time.
  Eigen::Vector3d added(double time_s, const MeasuredMotion& motion) {
    PoseMeasurement match;
    match.covariance = Eigen::Vector3d(0.1, 0.2, 0.01).asDiagonal();
    match.uncommon_variance = {0.05, 0.1, 0.005};
    repetition_.discount(at_s(time_s), motion, correlation_, match);
    return match.repeated_variance;
  }

  ErrorCorrelation correlation_{.match_m = {5.0, 10.0, 0.0}};
  MatchRepetition repetition_;
};

TEST_F(MatchRepetitionTest, ANearMatchRepeatsTheOneBeforeIt) {
  const Eigen::Vector3d first = added(1.0, kDriving);
  EXPECT_GT(first.minCoeff(), 0.0) << "uncertain matches have larger errors than they state";
  EXPECT_GT(added(1.1, kDriving).y(), 2.0 * first.y());
  repetition_.forget();
  EXPECT_EQ(added(1.2, kDriving), first);
}

TEST_F(MatchRepetitionTest, AMatchCountsMoreTheFartherItIsFromTheLast) {
  const double first = added(1.0, kDriving).y();
  const double after_1_m = added(1.1, kDriving).y();
  const double after_5_m = added(1.6, kDriving).y();
  EXPECT_GT(after_1_m, after_5_m);
  EXPECT_GT(after_5_m, first);
  EXPECT_NEAR(added(61.6, kDriving).y(), first, 1e-9);
}

TEST_F(MatchRepetitionTest, AnAxisWithIndependentErrorsRepeatsNothing) {
  const double first = added(1.0, kDriving).z();
  EXPECT_EQ(added(1.1, kDriving).z(), first);
}

TEST_F(MatchRepetitionTest, AStandingVehicleLearnsLittleFromTheSecondMatch) {
  const Eigen::Vector3d first = added(1.0, kStanding);
  EXPECT_GT(added(1.1, kStanding).y(), 10.0 * first.y());
  // All noise is alike there, also that of an axis without correlation.
  EXPECT_DOUBLE_EQ(added(1.2, kStanding).z(), first.z() + 4.0 * 0.01);
}

}  // namespace
}  // namespace bevloc
