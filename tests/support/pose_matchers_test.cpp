#include "tests/support/pose_matchers.h"

#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace bevloc::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename Value, typename Matcher>
std::string explanation(const Value& value, const Matcher& matcher) {
  testing::StringMatchResultListener listener;
  EXPECT_FALSE(testing::ExplainMatchResult(matcher, value, &listener));
  return listener.str();
}

TEST(PoseNearTest, ComparesEachCoordinateWithItsTolerance) {
  const Se2 expected{10.0, -5.0, 0.3};
  EXPECT_THAT(expected, PoseNear(expected, 0.0, 0.0));
  EXPECT_THAT((Se2{10.1, -5.1, 0.31}), PoseNear(expected, 0.1001, 0.0101));
  EXPECT_THAT((Se2{10.1, -5.0, 0.3}), Not(PoseNear(expected, 0.0999, 1.0)));
  EXPECT_THAT((Se2{10.0, -5.1, 0.3}), Not(PoseNear(expected, 0.0999, 1.0)));
  EXPECT_THAT((Se2{10.0, -5.0, 0.31}), Not(PoseNear(expected, 1.0, 0.0099)));
}

TEST(PoseNearTest, YawWrapsAround) {
  EXPECT_THAT((Se2{0.0, 0.0, radians(179.0)}), PoseNear({0.0, 0.0, radians(-179.0)}, 0.0, 0.036));
  EXPECT_THAT((Se2{0.0, 0.0, radians(179.0)}),
              Not(PoseNear({0.0, 0.0, radians(-179.0)}, 0.0, 0.034)));
  EXPECT_THAT((Se2{0.0, 0.0, radians(720.0)}), PoseNear({}, 0.0, 1e-12));
}

TEST(PoseNearTest, RefusesPosesThatAreNotFinite) {
  EXPECT_THAT((Se2{kNan, 0.0, 0.0}), Not(PoseNear({}, 1e9, 10.0)));
  EXPECT_THAT((Se2{0.0, kNan, 0.0}), Not(PoseNear({}, 1e9, 10.0)));
  EXPECT_THAT((Se2{0.0, 0.0, kNan}), Not(PoseNear({}, 1e9, 10.0)));
}

TEST(PoseNearTest, ExplainsAFailure) {
  const testing::Matcher<const Se2&> matcher =
      PoseNear({1.0, 2.0, radians(30.0)}, 0.25, radians(2.0));
  EXPECT_EQ(testing::DescribeMatcher<const Se2&>(matcher),
            "is within 0.25 m along x and y and 2 degrees of (x 1 m, y 2 m, yaw 30 degrees)");
  EXPECT_EQ(explanation(Se2{1.5, 2.0, radians(30.0)}, matcher),
            "whose error is (x 0.5 m, y 0 m, yaw 0 degrees)");
  EXPECT_EQ(testing::PrintToString(Se2{1.5, 2.0, 0.0}), "(x 1.5 m, y 2 m, yaw 0 degrees)");
}

TEST(RigidTransformNearTest, ComparesTranslationAndRotation) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  Se3 expected;
  expected.translation_m = {1.5, -0.3, 1.4};
  expected.rotation = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (const double angle_rad : {1e-9, 1e-3, 1.0, 3.0}) {
    Se3 actual = expected;
    actual.rotation = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix() * expected.rotation;
    EXPECT_THAT(actual, RigidTransformNear(expected, 0.0, 1.001 * angle_rad));
    EXPECT_THAT(actual, Not(RigidTransformNear(expected, 0.0, 0.999 * angle_rad)));
  }
  Se3 actual = expected;
  actual.translation_m += Eigen::Vector3d(0.03, 0.0, 0.04);
  EXPECT_THAT(actual, RigidTransformNear(expected, 0.0501, 0.0));
  EXPECT_THAT(actual, Not(RigidTransformNear(expected, 0.0499, 0.0)));
  EXPECT_THAT(explanation(actual, RigidTransformNear(expected, 0.01, 0.0)),
              HasSubstr("whose error is 0.05 m and 0 degrees"));
}

TEST(RigidTransformNearTest, RefusesWhatIsNoRigidTransform) {
  Se3 scaled;
  scaled.rotation *= 1.1;
  EXPECT_THAT(scaled, Not(RigidTransformNear({}, 0.0, 0.1)));
  Se3 not_finite;
  not_finite.rotation(1, 2) = kNan;
  EXPECT_THAT(not_finite, Not(RigidTransformNear({}, 1e9, 10.0)));
  not_finite = {};
  not_finite.translation_m.z() = kNan;
  EXPECT_THAT(not_finite, Not(RigidTransformNear({}, 1e9, 10.0)));
}

}  // namespace
}  // namespace bevloc::test
