// The baselines with perfect input and with empty input.
#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/baselines/distance_transform.h"
#include "evaluation/baselines/icp.h"
#include "evaluation/baselines/ipm.h"
#include "evaluation/baselines/nearest_line.h"
#include "pipeline/preprocessing/image_remap.h"
#include "sim/samples/sample_maker.h"
#include "tests/evaluation/baselines/street_scene.h"
#include "tests/support/pose_matchers.h"

namespace bevloc::evaluation {
namespace {

bool is_same(const Se2& a, const Se2& b) {
  return a.x_m == b.x_m && a.y_m == b.y_m && a.yaw_rad == b.yaw_rad;
}

/// Shifts along the street are smaller than half a crossing, so that each of its edges is nearest
/// to itself.
const std::array<Se2, 3> kCorrections{
    {{0.0, 0.0, 0.0}, {0.9, -0.4, radians(1.2)}, {-1.2, 0.6, radians(-0.7)}}};
const Se2 kLargeCorrection{1.8, 0.9, radians(1.8)};

struct OnMasks {
  std::string name;
  std::function<std::unique_ptr<Baseline>()> make;
};

class BaselineOnMasks : public testing::TestWithParam<OnMasks> {};

TEST_P(BaselineOnMasks, RecoversAKnownOffset) {
  const auto baseline = GetParam().make();
  for (const Se2& correction : kCorrections) {
    const StreetScene scene(correction);
    EXPECT_THAT(baseline->correct(scene.input()), test::PoseNear(correction, 0.05, radians(0.1)));
  }
}

TEST_P(BaselineOnMasks, KeepsThePriorIfTheMaskIsEmpty) {
  const auto baseline = GetParam().make();
  StreetScene scene(kCorrections[1]);
  std::ranges::fill(scene.perceived, 0.0F);
  EXPECT_THAT(baseline->correct(scene.input()), test::PoseNear({}, 1e-9, radians(1e-9)));
}

TEST_P(BaselineOnMasks, KeepsThePriorIfTheMapIsEmpty) {
  const auto baseline = GetParam().make();
  StreetScene scene(kCorrections[1]);
  std::ranges::fill(scene.raster, uint8_t{0});
  EXPECT_THAT(baseline->correct(scene.input()), test::PoseNear({}, 1e-9, radians(1e-9)));
}

TEST_P(BaselineOnMasks, StaysWithinTheRanges) {
  const StreetScene scene({3.0, 1.6, radians(3.0)});
  const Se2 found = GetParam().make()->correct(scene.input());
  const HypothesisGrid ranges;
  EXPECT_LE(std::abs(found.x_m), ranges.x_m.range);
  EXPECT_LE(std::abs(found.y_m), ranges.y_m.range);
  EXPECT_LE(std::abs(found.yaw_rad), ranges.yaw_rad.range);
}

TEST_P(BaselineOnMasks, IsRepeatable) {
  const auto baseline = GetParam().make();
  const StreetScene scene(kCorrections[2]);
  const Se2 first = baseline->correct(scene.input());
  EXPECT_TRUE(is_same(baseline->correct(scene.input()), first));
  EXPECT_TRUE(is_same(GetParam().make()->correct(scene.input()), first));
}

INSTANTIATE_TEST_SUITE_P(
    All, BaselineOnMasks,
    testing::Values(
        OnMasks{"icp", [] { return std::make_unique<IterativeClosestPoints>(HypothesisGrid{}); }},
        OnMasks{"distance_transform",
                [] { return std::make_unique<DistanceTransformAlignment>(HypothesisGrid{}); }}),
    [](const auto& instance) { return instance.param.name; });

TEST(DistanceTransformAlignmentTest, StartsFromSeveralCorrections) {
  const StreetScene scene(kLargeCorrection);
  EXPECT_THAT(DistanceTransformAlignment({}).correct(scene.input()),
              test::PoseNear(kLargeCorrection, 0.05, radians(0.1)));
}

TEST(IterativeClosestPointsTest, ConvergesToTheWrongEdgeOfACrossing) {
  const StreetScene scene(kLargeCorrection);
  const Se2 found = IterativeClosestPoints({}).correct(scene.input());
  EXPECT_GT(std::abs(found.x_m - kLargeCorrection.x_m), 1.0);
}

/// Images of the street from the scene's cameras, without calibration error: asphalt, with paint
/// 0.24 m wide on the dividers and on the edges of the crossing.
std::vector<uint8_t> painted_images(const StreetScene& scene) {
  constexpr uint8_t kAsphalt = 70;
  constexpr uint8_t kPaint = 200;
  constexpr double kHalfPaint_m = 0.12;
  ClassLines lines = lines_of_mask(scene.perceived);
  lines[0].insert(lines[0].end(), lines[1].begin(), lines[1].end());
  const NearestLine nearest(lines[0]);
  std::vector<uint8_t> images(kCameraCount * kNetworkImageSize, kAsphalt);
  for (size_t i = 0; i < kCameraCount; ++i) {
    const CameraModel& camera = scene.rig.cameras[i];
    for (int pixel = 0; pixel < kNetworkWidthPx * kNetworkHeightPx; ++pixel) {
      const Eigen::Vector3d ray =
          camera.vehicle_from_camera.rotation *
          camera.intrinsics.ray(Eigen::Vector2d(pixel % kNetworkWidthPx, pixel / kNetworkWidthPx));
      if (ray.z() >= 0.0) continue;
      const Eigen::Vector3d& from = camera.vehicle_from_camera.translation_m;
      const Eigen::Vector2d ground = (from - from.z() / ray.z() * ray).head<2>();
      const LinePoint* line = nearest.to(ground);
      if (line == nullptr || (line->position_m - ground).norm() > 1.0 ||
          std::abs(line->normal.dot(ground - line->position_m)) > kHalfPaint_m) {
        continue;
      }
      for (size_t colour = 0; colour < 3; ++colour) {
        images[i * kNetworkImageSize + colour * kNetworkImageSize / 3 + pixel] = kPaint;
      }
    }
  }
  return images;
}

class InversePerspectiveMappingTest : public testing::Test {
 protected:
  Se2 correct(const StreetScene& scene, const std::vector<uint8_t>& images,
              CameraMask cameras = CameraMask().set()) {
    BaselineInput input = scene.input();
    input.images = images;
    input.cameras = cameras;
    input.perceived = {};
    return baseline_.correct(input);
  }

  InversePerspectiveMapping baseline_{HypothesisGrid{}};
};

TEST_F(InversePerspectiveMappingTest, RecoversAKnownOffset) {
  for (const Se2& correction : kCorrections) {
    const StreetScene scene(correction);
    EXPECT_THAT(correct(scene, painted_images(scene)),
                test::PoseNear(correction, 0.12, radians(0.3)));
  }
}

TEST_F(InversePerspectiveMappingTest, ProjectsWithTheRigOfTheSample) {
  StreetScene scene(kCorrections[1]);
  for (CameraModel& camera : scene.rig.cameras) {
    camera.vehicle_from_camera.translation_m += Eigen::Vector3d(0.5, 0.2, 0.3);
  }
  EXPECT_THAT(correct(scene, painted_images(scene)),
              test::PoseNear(kCorrections[1], 0.12, radians(0.3)));
}

TEST_F(InversePerspectiveMappingTest, KeepsThePriorIfThereIsNoPaint) {
  const StreetScene scene(kCorrections[1]);
  const std::vector<uint8_t> bare(kCameraCount * kNetworkImageSize, uint8_t{70});
  EXPECT_THAT(correct(scene, bare), test::PoseNear({}, 1e-9, radians(1e-9)));
}

TEST_F(InversePerspectiveMappingTest, DoesNotReadAMissingCamera) {
  const StreetScene scene(kCorrections[1]);
  std::vector<uint8_t> images = painted_images(scene);
  const CameraMask cameras("101111");
  const Se2 found = correct(scene, images, cameras);
  EXPECT_FALSE(is_same(correct(scene, images), found));
  std::fill_n(images.begin() + 4 * kNetworkImageSize, kNetworkImageSize, uint8_t{255});
  EXPECT_TRUE(is_same(correct(scene, images, cameras), found));
  EXPECT_THAT(correct(scene, images, CameraMask{}), test::PoseNear({}, 1e-9, radians(1e-9)));
}

}  // namespace
}  // namespace bevloc::evaluation
