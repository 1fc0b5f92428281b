// Refines cameras by the ground that two pictures share.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/pipeline/calibration/refine/refinement_drive.h"

namespace bevloc {
namespace {

constexpr int kNoPaint = 2;  // front_right

/// What is simulated besides the true camera.
struct Ground {
  double pavement_m = 0.0;  ///< height of the ground that is more than 4 m beside the path
  int every_wrong = 0;      ///< one tie in this many is 16 px off; 0: none
};

/// The pixel of a point above the ground, to first order.
std::optional<Eigen::Vector2d> raised(const MomentView& view, const Eigen::Vector2d& point,
                                      double height_m) {
  const auto seen = view.look_at(point);
  if (!seen) return std::nullopt;
  return seen->pixel + height_m * seen->of_point.col(2);
}

/// Adds framesets in which the camera sees no paint, and the ground that it sees from each frameset
/// to the next.
void add_ties(RefinementProblem& problem, const Rig& rig, const CameraAdjustment& truth,
              const Drive& drive, const Ground& ground) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 0.2);
  const auto view_of = [&](int frame) {
    return *MomentView::make(rig.cameras[kNoPaint], truth, FrameVector::Zero(), drive.reference,
                             drive.time_of(frame));
  };
  for (int frame = 0; frame < Drive::kFrames; ++frame) {
    problem.add(frame, kNoPaint, drive.time_of(frame), {});
  }
  int count = 0;
  for (int frame = 0; frame + 1 < Drive::kFrames; ++frame) {
    const MomentView first = view_of(frame);
    const MomentView second = view_of(frame + 1);
    const Se2 vehicle_from_map = drive.reference.at(drive.time_of(frame))->inverse();
    std::vector<GroundTie> ties;
    for (double v = 230.0; v < 350.0; v += 30.0) {
      for (double u = 20.0; u < 640.0; u += 80.0) {
        const auto point = first.ground_at({u, v});
        if (!point) continue;
        const double height_m =
            std::abs((vehicle_from_map * *point).y()) > 4.0 ? ground.pavement_m : 0.0;
        const auto first_px = raised(first, *point, height_m);
        auto second_px = raised(second, *point, height_m);
        if (!first_px || !second_px || second_px->x() < 0 || second_px->x() > 639 ||
            second_px->y() > 359) {
          continue;
        }
        if (ground.every_wrong > 0 && ++count % ground.every_wrong == 0) second_px->x() += 16.0;
        // Two draws among the arguments of one call would come in an order that depends on the
        // compiler.
        const double down_px = noise(random);
        const double right_px = noise(random);
        ties.push_back({*first_px, *second_px + Eigen::Vector2d(right_px, down_px)});
      }
    }
    problem.add_ties({frame, kNoPaint, drive.time_of(frame)},
                     {frame + 1, kNoPaint, drive.time_of(frame + 1)}, std::move(ties));
  }
}

CameraAdjustment error_of_camera() {
  CameraAdjustment error;
  error << radians(0.5), radians(-0.6), radians(0.4), 0.05, -0.04, 0.05, 0.005, 0.02;
  return error;
}

/// What the refinement finds for the camera.
CameraRefinement refined_by_ties(const Ground& ground) {
  const Rig rig = test::demo_rig();
  const Drive drive(true, 4.0);
  RefinementProblem problem(rig, drive.reference, {});
  add_ties(problem, rig, error_of_camera(), drive, ground);
  for (const double sigma_scale : {8.0, 4.0, 2.0, 1.0}) problem.solve(0.04, sigma_scale);
  problem.finish(0.014);
  return problem.result(0.014).cameras[kNoPaint];
}

/// Nothing tells how high the ground is, so the camera's height is not observable.
void expect_found(const CameraRefinement& camera, double most_rad, double most_s) {
  const CameraAdjustment error = camera.change - error_of_camera();
  for (const int p : {kPitch, kYaw, kRoll}) {
    EXPECT_FALSE(camera.unobservable[static_cast<size_t>(p)]) << p;
    EXPECT_LT(std::abs(error[p]), most_rad) << p;
  }
  EXPECT_TRUE(camera.unobservable[kUp]);
  EXPECT_EQ(camera.change[kUp], 0.0);
  EXPECT_LT(std::abs(error[kTimeOffset]), most_s);
}

TEST(RefinementTies, FindACameraThatSeesNoPaint) {
  const CameraRefinement camera = refined_by_ties({});
  EXPECT_EQ(camera.found, 0);
  EXPECT_GT(camera.ties, 500);
  expect_found(camera, radians(0.05), 0.002);
}

TEST(RefinementTies, AHigherPavementChangesTheCameraLittle) {
  expect_found(refined_by_ties({.pavement_m = 0.1}), radians(0.1), 0.003);
}

TEST(RefinementTies, WrongTiesCountLittle) {
  expect_found(refined_by_ties({.every_wrong = 5}), radians(0.1), 0.003);
}

TEST(RefinementTies, ExpectedViewFollowsTheEstimate) {
  const Rig rig = test::demo_rig();
  const Drive drive(true, 4.0);
  RefinementProblem problem(rig, drive.reference, {});
  const RefinementProblem::Picture picture{0, kNoPaint, drive.time_of(0)};
  const CameraModel before = problem.expected_view(picture)->camera();
  EXPECT_TRUE(before.vehicle_from_camera.rotation.isApprox(
      rig.cameras[kNoPaint].vehicle_from_camera.rotation));
  add_ties(problem, rig, error_of_camera(), drive, {});
  problem.solve(0.04);
  EXPECT_TRUE(problem.expected_view(picture)->camera().vehicle_from_camera.rotation.isApprox(
      adjusted(rig.cameras[kNoPaint], problem.change(kNoPaint)).vehicle_from_camera.rotation));
  EXPECT_FALSE(problem.change(kNoPaint).isZero());
  EXPECT_FALSE(problem.expected_view({0, kNoPaint, drive.time_of(0) + std::chrono::hours(1)}));
}

}  // namespace
}  // namespace bevloc
