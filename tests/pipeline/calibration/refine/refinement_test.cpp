// Recovers known errors of a calibration from exact and noisy sightings of paint.
#include "pipeline/calibration/refine/refinement.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/pipeline/calibration/refine/refinement_drive.h"

namespace bevloc {
namespace {

/// All cameras, turned together about the vehicle's axes.
Rig on_tilted_body(const Rig& rig, const Eigen::Vector3d& tilt_rad) {
  const Se3 body{rotation_by(tilt_rad), Eigen::Vector3d::Zero()};
  Rig tilted = rig;
  for (CameraModel& camera : tilted.cameras) {
    camera.vehicle_from_camera = body * camera.vehicle_from_camera;
  }
  return tilted;
}

std::array<CameraAdjustment, kCameraCount> some_errors() {
  std::array<CameraAdjustment, kCameraCount> errors;
  for (int c = 0; c < kCameraCount; ++c) {
    for (int p = 0; p < kCameraParameters; ++p) {
      const double sigma = kCameraParameterInfos[static_cast<size_t>(p)].expected_error;
      errors[c][p] = 0.5 * sigma * std::sin(3.0 * c + 1.7 * p + 1.0);
    }
    errors[c][kTimeOffset] = 0.0;
  }
  return errors;
}

TEST(Refinement, RecoversAllParametersOfAWindingDrive) {
  const Rig rig = test::demo_rig();
  Rig truth = rig;
  const auto errors = some_errors();
  for (int c = 0; c < kCameraCount; ++c) truth.cameras[c] = adjusted(rig.cameras[c], errors[c]);
  const Drive drive(true, 4.0);
  RefinementOptions options;
  // The reference is exact, so errors that all cameras share count as errors of the cameras.
  options.reference_position_m = 1e-3;
  options.reference_yaw_rad = 1e-4;
  options.body_tilt_rad = 1e-4;
  options.body_lift_m = 1e-3;
  RefinementProblem problem(rig, drive.reference, options);
  // Each round looks for lines where the last estimate expects them, with a smaller sigma, as
  // refine_rig() does.
  for (const double sigma_scale : {8.0, 4.0, 1.0}) {
    problem.clear_sightings();
    add_sightings(problem, rig, [&truth](int) { return truth; }, drive,
                  {.time_offset_s = 0.02, .noise_px = 0.3});
    problem.solve(kEverything_rad, sigma_scale);
  }
  problem.finish(kEverything_rad);
  const RigRefinement result = problem.result(kEverything_rad);
  EXPECT_EQ(result.frames, Drive::kFrames);
  auto truth_of = errors;
  for (CameraAdjustment& of : truth_of) of[kTimeOffset] = 0.02;
  int observable = 0;
  for (int c = 0; c < kCameraCount; ++c) {
    const CameraRefinement& camera = result.cameras[c];
    observable += kCameraParameters - static_cast<int>(camera.unobservable.count());
    const CameraAdjustment error = camera.change - truth_of[c];
    for (int p = 0; p < kCameraParameters; ++p) {
      if (camera.unobservable[static_cast<size_t>(p)]) {
        EXPECT_EQ(camera.change[p], 0.0) << kCameraNames[c] << p;
      } else if (camera.unobservable.none() && p != kFocal) {
        const double most = p == kTimeOffset ? 0.003 : p < kForward ? radians(0.1) : 0.02;
        EXPECT_LT(std::abs(error[p]), most) << kCameraNames[c] << p;
      }
    }
  }
  // Two cameras start so far off that their paint does not agree afterwards, so they stay as they
  // were.
  EXPECT_GE(observable, 32);
}

TEST(Refinement, TakesWhatAllCamerasShareForTheBody) {
  const Rig rig = test::demo_rig();
  const Drive drive(true, 4.0);
  // The body pitches to and fro by 0.4 degrees, which no camera's mounting does.
  const auto pitched = [&rig](int frame) {
    const double pitch_rad = radians(frame % 2 == 0 ? 0.4 : -0.4);
    return on_tilted_body(rig, {0.0, pitch_rad, 0.0});
  };
  RefinementProblem problem(rig, drive.reference, {});
  add_sightings(problem, rig, pitched, drive, {.noise_px = 0.1});
  problem.solve(kEverything_rad);
  const RigRefinement result = problem.result(kEverything_rad);
  for (int c = 0; c < kCameraCount; ++c) {
    for (const int p : {kPitch, kYaw, kRoll}) {
      EXPECT_LT(std::abs(result.cameras[c].change[p]), radians(0.05)) << c << p;
    }
    EXPECT_LT(result.cameras[c].after_px, 0.5);
  }
}

TEST(Refinement, ExpectsTheTiltThatTheAccelerationsCause) {
  constexpr double kRollPerAcceleration = 0.005;  // rad per m/s^2
  const Rig rig = test::demo_rig();
  const Drive drive(true, 4.0);
  const auto expected_roll = [&drive](int frame) {
    return kRollPerAcceleration * drive.lateral_mps2(frame);
  };
  const auto rolled = [&](int frame) {
    return on_tilted_body(rig, {expected_roll(frame), 0.0, 0.0});
  };
  RefinementProblem problem(rig, drive.reference, {});
  add_sightings(problem, rig, rolled, drive, {.noise_px = 0.1});
  problem.solve(kEverything_rad);
  double most_rad = 0.0;
  for (int frame = 0; frame < Drive::kFrames; ++frame) {
    const double roll_rad = expected_roll(frame);
    most_rad = std::max(most_rad, std::abs(roll_rad));
    const Eigen::Matrix3d rolled_back = rotation_by({-roll_rad, 0.0, 0.0});
    EXPECT_TRUE(
        problem.expected_body_from_vehicle(frame).rotation.isApprox(rolled_back, radians(0.15)))
        << frame;
  }
  EXPECT_GT(most_rad, radians(0.4));
}

TEST(Refinement, ExpectsNoTiltOfAFramesetThatWasNotAdded) {
  const Rig rig = test::demo_rig();
  const Drive drive(true, 4.0);
  const RefinementProblem problem(rig, drive.reference, {});
  EXPECT_TRUE(problem.expected_body_from_vehicle(0).rotation.isIdentity());
  EXPECT_TRUE(problem.expected_body_from_vehicle(0).translation_m.isZero());
}

TEST(Refinement, RefusesWhatAStraightRoadCannotShow) {
  const Rig rig = test::demo_rig();
  const Drive drive(false, 0.0);
  RefinementProblem problem(rig, drive.reference, {});
  add_sightings(problem, rig, [&rig](int) { return rig; }, drive,
                {.crossing = false, .noise_px = 0.3});
  problem.solve(kEverything_rad);
  problem.finish(kEverything_rad);
  const RigRefinement result = problem.result(kEverything_rad);
  for (const CameraRefinement& camera : result.cameras) {
    // Lines along the road look the same from every place along the road.
    EXPECT_TRUE(camera.unobservable[kForward]);
    EXPECT_TRUE(camera.unobservable[kTimeOffset]);
    EXPECT_EQ(camera.change[kForward], 0.0);
    EXPECT_EQ(camera.change[kTimeOffset], 0.0);
  }
  // Lines that run away from the front and back cameras show where these cameras point.
  for (const int c : {1, 4}) EXPECT_FALSE(result.cameras[c].unobservable[kYaw]) << c;
}

TEST(Refinement, ACameraThatSeesTooLittleDoesNotChangeTheOthers) {
  constexpr int kBlind = 2;
  const Rig rig = test::demo_rig();
  Rig truth = rig;
  truth.cameras[kBlind] = adjusted(rig.cameras[kBlind], {0.01, 0.01, -0.01, 0.0, 0.0, 0.1, 0, 0});
  const Drive drive(true, 4.0);
  const auto refined_with = [&](int seen_of_blind) {
    RefinementProblem problem(rig, drive.reference, {});
    add_sightings(problem, rig, [&truth](int) { return truth; }, drive,
                  {.nearly_blind = kBlind, .seen_of_blind = seen_of_blind});
    problem.solve(kEverything_rad);
    problem.finish(kEverything_rad);
    return problem.result(kEverything_rad);
  };
  const RigRefinement with = refined_with(90);
  const RigRefinement without = refined_with(0);
  EXPECT_TRUE(with.cameras[kBlind].unobservable.all());
  for (int c = 0; c < kCameraCount; ++c) {
    for (int p = 0; p < kCameraParameters; ++p) {
      const double expected = kCameraParameterInfos[static_cast<size_t>(p)].expected_error;
      EXPECT_NEAR(with.cameras[c].change[p], without.cameras[c].change[p], 1e-3 * expected)
          << kCameraNames[c] << p;
    }
  }
}

TEST(Refinement, KeepsACameraThatWouldChangeBeyondWhatMountsDo) {
  constexpr int kRaised = 1;
  const Rig rig = test::demo_rig();
  Rig truth = rig;
  truth.cameras[kRaised].vehicle_from_camera.translation_m.z() += 0.5;
  const Drive drive(true, 4.0);
  RefinementProblem problem(rig, drive.reference, {});
  add_sightings(problem, rig, [&truth](int) { return truth; }, drive, {});
  problem.solve(kEverything_rad, 20.0);
  problem.solve(kEverything_rad);
  EXPECT_GT(problem.change(kRaised)[kUp], 0.3);
  problem.finish(kEverything_rad);
  const RigRefinement result = problem.result(kEverything_rad);
  EXPECT_TRUE(result.cameras[kRaised].unobservable.all());
  EXPECT_TRUE(result.cameras[kRaised].change.isZero());
  EXPECT_LT(std::abs(result.cameras[4].change[kUp]), 0.02);
}

TEST(Refinement, IgnoresPaintThatIsNotInTheMap) {
  const Rig rig = test::demo_rig();
  const Drive drive(true, 4.0);
  RefinementProblem problem(rig, drive.reference, {});
  add_sightings(problem, rig, [&rig](int) { return rig; }, drive, {});
  // In each frameset, one camera sees a line that the map lacks, five times and always on one side.
  for (int frame = 0; frame < Drive::kFrames; ++frame) {
    PaintSighting wrong;
    wrong.point_m = *drive.reference.at(drive.time_of(frame)) * Eigen::Vector2d(8.0, 1.75);
    const auto px = seen(rig.cameras[1], *drive.reference.at(drive.time_of(frame)), wrong.point_m);
    ASSERT_TRUE(px);
    wrong.predicted_px = *px;
    wrong.normal_px = {1.0, 0.0};
    wrong.pixels_per_m = 20.0;
    wrong.candidates = 1;
    wrong.offset_px[0] = 6.0;
    problem.add(frame, 1, drive.time_of(frame), std::vector<PaintSighting>(5, wrong));
  }
  problem.solve(0.016);
  EXPECT_LT(std::abs(problem.change(1)[kYaw]), radians(0.05));
}

}  // namespace
}  // namespace bevloc
