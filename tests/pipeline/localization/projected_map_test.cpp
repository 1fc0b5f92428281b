// Tests where the lines of a map lie around the vehicle and in a camera image.
#include "pipeline/localization/projected_map.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

/// Looks forward and level from 1.5 m above the vehicle's origin.
CameraModel front_camera() {
  CameraModel camera;
  camera.intrinsics.width_px = 640;
  camera.intrinsics.height_px = 360;
  camera.intrinsics.fx_px = camera.intrinsics.fy_px = 500.0;
  camera.intrinsics.cx_px = 320.0;
  camera.intrinsics.cy_px = 180.0;
  camera.vehicle_from_camera.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  camera.vehicle_from_camera.translation_m = {0.0, 0.0, 1.5};
  return camera;
}

HdMap street() {
  HdMap map;
  map.elements.push_back(
      {ElementClass::kLaneDivider, Appearance::kUnknown, {{-30.0, 0.0}, {0.0, 0.0}, {30.0, 0.0}}});
  map.elements.push_back({ElementClass::kPedestrianCrossing,
                          Appearance::kUnknown,
                          {{10, -3}, {13, -3}, {13, 3}, {10, 3}}});
  return map;
}

TEST(ProjectedMap, JoinsTheSegmentsOfAnElement) {
  const HdMap map = street();
  const MapIndex index(map);
  ProjectedMap projected(index);
  const auto lines = projected.around({0.0, 1.0, 0.0}, 50.0);
  ASSERT_EQ(lines.size(), 2u);
  ASSERT_EQ(lines[0].points.size(), 3u);
  EXPECT_EQ(lines[0].points[0], Eigen::Vector2d(-30.0, -1.0));
  ASSERT_EQ(lines[1].points.size(), 5u) << "a ring is closed";
  EXPECT_EQ(lines[1].points.front(), lines[1].points.back());
}

TEST(ProjectedMap, FindsNothingFarAway) {
  const HdMap map = street();
  const MapIndex index(map);
  EXPECT_TRUE(ProjectedMap(index).around({1000.0, 0.0, 0.0}, 50.0).empty());
}

TEST(ProjectedMap, ProjectsTheGround) {
  const HdMap map = street();
  const MapIndex index(map);
  ProjectedMap projected(index);
  // 2 m to the right of the line and parallel to it.
  const auto lines = projected.in_image({0.0, -2.0, 0.0}, front_camera());
  bool found = false;
  for (const ProjectedLine& line : lines) {
    if (line.element_class != ElementClass::kLaneDivider) continue;
    for (const Eigen::Vector2d& pixel : line.points) {
      // A point at distance x has u = 320 - 500 * 2 / x and v = 180 + 500 * 1.5 / x.
      EXPECT_NEAR((320.0 - pixel.x()) / 2.0, (pixel.y() - 180.0) / 1.5, 1e-9);
      found = found || (pixel - Eigen::Vector2d(220.0, 255.0)).norm() < 1e-9;  // x = 10 m
    }
  }
  EXPECT_TRUE(found);
}

TEST(ProjectedMap, LeavesOutWhatIsBehindTheCamera) {
  HdMap map;
  map.elements.push_back(
      {ElementClass::kLaneDivider, Appearance::kUnknown, {{-30.0, 0.0}, {-1.0, 0.0}}});
  const MapIndex index(map);
  ProjectedMap projected(index);
  EXPECT_EQ(projected.around({}, 50.0).size(), 1u);
  EXPECT_TRUE(projected.in_image({}, front_camera()).empty());
}

}  // namespace
}  // namespace bevloc
