// GoogleMock matchers for poses in the plane (Se2) and rigid transforms in space (Se3).
#pragma once

#include <cmath>
#include <numbers>
#include <ostream>

#include <gmock/gmock.h>

#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"

namespace bevloc {

// GoogleTest finds these by argument-dependent lookup and uses them to print failures.
inline void PrintTo(const Se2& pose, std::ostream* out) {
  *out << "(x " << pose.x_m << " m, y " << pose.y_m << " m, yaw " << degrees(pose.yaw_rad)
       << " degrees)";
}

inline void PrintTo(const Se3& transform, std::ostream* out) {
  const Eigen::Vector3d& t = transform.translation_m;
  const Eigen::Matrix3d& r = transform.rotation;
  *out << "(translation " << t.x() << ", " << t.y() << ", " << t.z() << " m, rotation rows";
  for (int row = 0; row < 3; ++row) {
    *out << " [" << r(row, 0) << ", " << r(row, 1) << ", " << r(row, 2) << "]";
  }
  *out << ")";
}

namespace test {

class PoseNearMatcher {
 public:
  using is_gtest_matcher = void;

  PoseNearMatcher(const Se2& expected, double position_tolerance_m, double yaw_tolerance_rad)
      : expected_(expected),
        position_tolerance_m_(position_tolerance_m),
        yaw_tolerance_rad_(yaw_tolerance_rad) {}

  bool MatchAndExplain(const Se2& actual, std::ostream* explanation) const {
    const double x_m = actual.x_m - expected_.x_m;
    const double y_m = actual.y_m - expected_.y_m;
    const double yaw_rad = wrap_angle(actual.yaw_rad - expected_.yaw_rad);
    if (explanation != nullptr) {
      *explanation << "whose error is ";
      PrintTo(Se2{x_m, y_m, yaw_rad}, explanation);
    }
    return std::abs(x_m) <= position_tolerance_m_ && std::abs(y_m) <= position_tolerance_m_ &&
           std::abs(yaw_rad) <= yaw_tolerance_rad_;
  }

  void DescribeTo(std::ostream* out) const { describe("is", *out); }
  void DescribeNegationTo(std::ostream* out) const { describe("is not", *out); }

 private:
  void describe(const char* verb, std::ostream& out) const {
    out << verb << " within " << position_tolerance_m_ << " m along x and y and "
        << degrees(yaw_tolerance_rad_) << " degrees of ";
    PrintTo(expected_, &out);
  }

  Se2 expected_;
  double position_tolerance_m_;
  double yaw_tolerance_rad_;
};

class RigidTransformNearMatcher {
 public:
  using is_gtest_matcher = void;

  RigidTransformNearMatcher(const Se3& expected, double translation_tolerance_m,
                            double rotation_tolerance_rad)
      : expected_(expected),
        translation_tolerance_m_(translation_tolerance_m),
        rotation_tolerance_rad_(rotation_tolerance_rad) {}

  bool MatchAndExplain(const Se3& actual, std::ostream* explanation) const {
    const double distance_m = (actual.translation_m - expected_.translation_m).norm();
    const double angle_rad = angle_between(actual.rotation, expected_.rotation);
    if (explanation != nullptr) {
      *explanation << "whose error is " << distance_m << " m and " << degrees(angle_rad)
                   << " degrees";
    }
    return distance_m <= translation_tolerance_m_ && angle_rad <= rotation_tolerance_rad_;
  }

  void DescribeTo(std::ostream* out) const { describe("is", *out); }
  void DescribeNegationTo(std::ostream* out) const { describe("is not", *out); }

 private:
  /// Computed from the Frobenius norm of the difference, which is 2 sqrt(2) sin(angle / 2). That is
  /// exact for small angles, and it also detects matrices that are not rotations.
  static double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    const double half_sine = (a - b).norm() / (2.0 * std::numbers::sqrt2);
    return half_sine > 1.0 ? std::numbers::pi : 2.0 * std::asin(half_sine);
  }

  void describe(const char* verb, std::ostream& out) const {
    out << verb << " within " << translation_tolerance_m_ << " m and "
        << degrees(rotation_tolerance_rad_) << " degrees of ";
    PrintTo(expected_, &out);
  }

  Se3 expected_;
  double translation_tolerance_m_;
  double rotation_tolerance_rad_;
};

/// Matches a pose whose x and y each differ from `expected` by at most `position_tolerance_m`, and
/// whose yaw differs by at most `yaw_tolerance_rad`. Yaws that differ by full turns are equal. A
/// pose that is not finite never matches.
inline testing::Matcher<const Se2&> PoseNear(const Se2& expected, double position_tolerance_m,
                                             double yaw_tolerance_rad) {
  return PoseNearMatcher(expected, position_tolerance_m, yaw_tolerance_rad);
}

/// Matches a transform whose translation is at most `translation_tolerance_m` away from that of
/// `expected`, and whose rotation differs by an angle of at most `rotation_tolerance_rad`. A
/// transform that is not finite never matches.
inline testing::Matcher<const Se3&> RigidTransformNear(const Se3& expected,
                                                       double translation_tolerance_m,
                                                       double rotation_tolerance_rad) {
  return RigidTransformNearMatcher(expected, translation_tolerance_m, rotation_tolerance_rad);
}

}  // namespace test
}  // namespace bevloc
