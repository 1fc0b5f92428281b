// GNSS that the estimator refuses, that sends nothing, or whose heading is uncertain.
#include "tests/pipeline/tracker/pose_estimator_fixture.h"

namespace bevloc {
namespace {

using test::PoseEstimatorTest;

TEST_F(PoseEstimatorTest, RefusedGnssEndsAPoseWithoutMatches) {
  has_matches_ = false;
  drive(1.0);
  drive(3.0, 20.0);
  EXPECT_GT(error_m(), 15.0) << "the pose has begun again where GNSS is";
}

TEST_F(PoseEstimatorTest, GnssThatWasRefusedBeforeATunnelDoesNotEndThePose) {
  drive(3.0, 20.0);
  has_gnss_ = false;
  drive(10.0);
  has_matches_ = false;
  drive(1.5);
  EXPECT_LT(error_m(), 1.0);
}

TEST_F(PoseEstimatorTest, ExcludedGnssDoesNotEndThePose) {
  drive(3.0, 20.0);
  has_matches_ = false;
  drive(2.0, 20.0);
  EXPECT_LT(error_m(), 1.0);
}

TEST_F(PoseEstimatorTest, RefusalsOfGnssBeforeAPauseDoNotEndThePose) {
  has_matches_ = false;
  drive(1.0);
  drive(1.0, 20.0);
  has_gnss_ = false;
  drive(3.0);
  has_gnss_ = true;
  drive(1.0, 20.0);
  EXPECT_LT(error_m(), 1.0);
}

TEST_F(PoseEstimatorTest, AnUncertainHeadingOfGnssHasNoPartInTheProtectionLevel) {
  PoseEstimator without = estimator_;
  GnssSample gnss = vehicle_.gnss();
  gnss.yaw->sigma_rad = 2.0;
  EXPECT_EQ(estimator_.add(gnss), TrackerUpdate::kAccepted);
  gnss.yaw.reset();
  EXPECT_EQ(without.add(gnss), TrackerUpdate::kAccepted);
  const TrackedPose pose = *without.pose_at(at_s(time_s_));
  EXPECT_EQ(estimator_.protection_of(pose, {}), without.protection_of(pose, {}));
}

}  // namespace
}  // namespace bevloc
