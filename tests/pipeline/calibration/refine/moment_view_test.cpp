// Derivatives of a camera's pixels against differences of two views.
#include "pipeline/calibration/refine/moment_view.h"

#include <gtest/gtest.h>

#include "tests/support/demo_rig.h"

namespace bevloc {
namespace {

constexpr int kSideways = 0;
constexpr double kSmall = 1e-6;

/// A bend at 8 m/s.
ReferenceTrajectory bend() {
  std::vector<ReferenceTrajectory::Pose> poses;
  Se2 pose{20.0, -30.0, 2.5};
  for (int i = 0; i < 300; ++i) {
    poses.push_back({Time{} + from_seconds(0.01 * i), pose});
    pose = pose * arc_motion(8.0, 0.3, 0.01);
  }
  return ReferenceTrajectory(std::move(poses));
}

class MomentViewTest : public ::testing::Test {
 protected:
  MomentViewTest() : rig_(test::demo_rig()), reference_(bend()) {
    change_ << 0.01, -0.02, 0.005, 0.03, -0.05, 0.02, 0.01, 0.004;
    error_ << 0.01, -0.008, 0.002, 0.02, -0.03, 0.015;
  }

  MomentView view(const CameraAdjustment& change, const FrameVector& error) const {
    return *MomentView::make(rig_.cameras[kSideways], change, error, reference_, time_);
  }

  /// A point that the camera sees.
  Eigen::Vector2d point() const { return *view(change_, error_).ground_at({200.0, 300.0}); }

  Rig rig_;
  ReferenceTrajectory reference_;
  CameraAdjustment change_;
  FrameVector error_;
  const Time time_ = Time{} + from_seconds(1.5);
};

TEST_F(MomentViewTest, PixelAndGroundAreInverse) {
  const MomentView moment = view(change_, error_);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(200.0, 300.0), Eigen::Vector2d(30.0, 230.0),
                                       Eigen::Vector2d(600.0, 350.0)}) {
    const auto ground = moment.ground_at(pixel);
    ASSERT_TRUE(ground);
    EXPECT_TRUE(moment.project(*ground)->isApprox(pixel, 1e-6));
    EXPECT_TRUE(moment.look_at(*ground)->pixel.isApprox(pixel, 1e-6));
  }
}

TEST_F(MomentViewTest, ShowsNoGroundAboveTheHorizon) {
  EXPECT_FALSE(view(change_, error_).ground_at({320.0, 20.0}));
}

TEST_F(MomentViewTest, KnowsWhereTheCameraIs) {
  const Eigen::Vector2d eye = view(CameraAdjustment::Zero(), FrameVector::Zero()).eye() -
                              reference_.at(time_)->translation();
  EXPECT_NEAR(eye.norm(),
              rig_.cameras[kSideways].vehicle_from_camera.translation_m.head<2>().norm(), 1e-9);
}

TEST_F(MomentViewTest, NeedsTheReferenceAroundTheTime) {
  EXPECT_FALSE(MomentView::make(rig_.cameras[kSideways], change_, error_, reference_,
                                Time{} + from_seconds(5.0)));
}

TEST_F(MomentViewTest, DerivativesByTheCamera) {
  const PointView seen = *view(change_, error_).look_at(point());
  for (int p = 0; p < kCameraParameters; ++p) {
    // The reference is linear between two poses, so the step of the time offset is longer.
    const double step = p == kTimeOffset ? 2e-3 : kSmall;
    if (p <= kRoll) continue;  // see DerivativesByTheRotation
    CameraAdjustment more = change_;
    CameraAdjustment less = change_;
    more[p] += step;
    less[p] -= step;
    Eigen::Vector2d slope =
        (*view(more, error_).project(point()) - *view(less, error_).project(point())) /
        (2.0 * step);
    if (p == kFocal) slope *= 1.0 + change_[kFocal];  // by a relative change of the present one
    EXPECT_TRUE(seen.of_camera.col(p).isApprox(slope, 5e-3)) << p;
  }
}

/// A rotation is changed by a further turn about the axes of the turned camera.
TEST_F(MomentViewTest, DerivativesByTheRotation) {
  change_.head<3>().setZero();
  error_.head<3>().setZero();
  const PointView seen = *view(change_, error_).look_at(point());
  for (int axis = 0; axis < 3; ++axis) {
    CameraAdjustment turned = change_;
    turned[axis] += kSmall;
    FrameVector tilted = error_;
    tilted[axis] += kSmall;
    const Eigen::Vector2d by_camera =
        (*view(turned, error_).project(point()) - seen.pixel) / kSmall;
    const Eigen::Vector2d by_body = (*view(change_, tilted).project(point()) - seen.pixel) / kSmall;
    EXPECT_TRUE(seen.of_camera.col(axis).isApprox(by_camera, 1e-3)) << axis;
    EXPECT_TRUE(seen.of_frame.col(axis).isApprox(by_body, 1e-3)) << axis;
  }
}

TEST_F(MomentViewTest, DerivativesByPlaceAndPoint) {
  const PointView seen = *view(change_, error_).look_at(point());
  for (int axis = 0; axis < 3; ++axis) {
    FrameVector moved = error_;
    moved[kForwardError + axis] += kSmall;
    const Eigen::Vector2d slope = (*view(change_, moved).project(point()) - seen.pixel) / kSmall;
    EXPECT_TRUE(seen.of_frame.col(kForwardError + axis).isApprox(slope, 1e-3)) << axis;
  }
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d there = point() + kSmall * Eigen::Vector2d::Unit(axis);
    const Eigen::Vector2d slope = (*view(change_, error_).project(there) - seen.pixel) / kSmall;
    EXPECT_TRUE(seen.of_point.col(axis).isApprox(slope, 1e-3)) << axis;
  }
  // Ground that is higher looks like the same ground below a lower camera.
  error_.head<3>().setZero();
  const PointView level = *view(change_, error_).look_at(point());
  EXPECT_TRUE(level.of_point.col(2).isApprox(-level.of_camera.col(kUp), 1e-9));
}

}  // namespace
}  // namespace bevloc
