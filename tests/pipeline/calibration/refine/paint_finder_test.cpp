// Finds painted lines in pictures that follow from formulas.
#include "pipeline/calibration/refine/paint_finder.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/calibration/reference_trajectory.h"
#include "tests/pipeline/calibration/refine/road_picture.h"
#include "tests/support/demo_rig.h"

namespace bevloc {
namespace {

/// Grey asphalt with a painted line at y = `left_m` and a bar edge at x = `edge_m`.
GreyImage picture_of_paint(const CameraModel& camera, double left_m, double edge_m) {
  return RoadPainter(camera.intrinsics)
      .picture(camera.vehicle_from_camera, [=](double x_m, double y_m) {
        const bool line = std::abs(y_m - left_m) < 0.06;
        const bool bar = x_m > edge_m && x_m < edge_m + 3.0 && y_m < -2.5;
        return line || bar ? 200.0 : 80.0;
      });
}

/// Asphalt, and to its left a stripe and other ground. The middle of the stripe is the map's line.
GreyImage picture_of_stripe(const CameraModel& camera, double width_m, double grey_beyond) {
  return RoadPainter(camera.intrinsics)
      .picture(camera.vehicle_from_camera, [=](double, double y_m) {
        const double off_m = y_m - 1.75;
        if (std::abs(off_m) < 0.5 * width_m) return 200.0;
        return off_m > 0.0 ? grey_beyond : 80.0;
      });
}

HdMap street(bool crossing) {
  HdMap map;
  if (crossing) {
    map.elements = {{ElementClass::kPedestrianCrossing,
                     Appearance::kZebra,
                     {{10.0, -8.0}, {13.0, -8.0}, {13.0, 8.0}, {10.0, 8.0}}}};
  } else {
    map.elements = {
        {ElementClass::kLaneDivider, Appearance::kSolid, {{-30.0, 1.75}, {30.0, 1.75}}},
        {ElementClass::kRoadBoundary, Appearance::kKerb, {{-30.0, 4.0}, {30.0, 4.0}}},
        {ElementClass::kLaneDivider, Appearance::kDoubleSolid, {{-30.0, -1.0}, {30.0, -1.0}}}};
  }
  return map;
}

CameraModel front_camera() {
  return test::demo_rig().cameras[1];
}

std::vector<PaintSighting> sightings_in(const GreyImage& image, const CameraModel& camera,
                                        const HdMap& map) {
  constexpr double kReach_px = 16.0;
  std::vector<PaintPoint> points;
  find_paint_points(MapIndex(map), {}, 25.0, points);
  return find_paint(image, camera, {}, points, kReach_px);
}

TEST(FindPaintPoints, TakesDividersAndTheLongSidesOfCrossings) {
  const HdMap lines = street(false);
  std::vector<PaintPoint> points;
  find_paint_points(MapIndex(lines), {}, 20.0, points);
  EXPECT_NEAR(static_cast<double>(points.size()), 200.0, 4.0);
  for (const PaintPoint& point : points) EXPECT_NEAR(point.point_m.y(), 1.75, 1e-9);
  const HdMap crossing = street(true);
  find_paint_points(MapIndex(crossing), {}, 40.0, points);
  ASSERT_FALSE(points.empty());
  for (const PaintPoint& point : points) {
    EXPECT_EQ(point.kind, PaintKind::kStep);
    EXPECT_NEAR(std::abs(point.point_m.x() - 11.5), 1.5, 1e-9);
    // The direction is towards the bars.
    EXPECT_GT(point.across.x() * (11.5 - point.point_m.x()), 0.0);
  }
}

TEST(FindPaint, MeasuresAStripeToAFractionOfAPixel) {
  const CameraModel camera = front_camera();
  // The paint is 0.1 m to the left of the map.
  const auto sightings = sightings_in(picture_of_paint(camera, 1.85, 100.0), camera, street(false));
  ASSERT_GT(sightings.size(), 10U);
  int found = 0;
  for (const PaintSighting& sighting : sightings) {
    if (sighting.candidates == 0) continue;
    ++found;
    EXPECT_NEAR(std::abs(sighting.offset_px[0]), 0.1 * sighting.pixels_per_m,
                0.3 + 0.02 * sighting.pixels_per_m);
    EXPECT_LT(sighting.offset_px[0] * sighting.normal_px.x(), 0.0) << "left in the image, too";
  }
  EXPECT_GT(found, static_cast<int>(sightings.size()) * 3 / 4);
}

TEST(FindPaint, FindsNothingOnBareAsphalt) {
  const CameraModel camera = front_camera();
  const GreyImage image = picture_of_paint(camera, 100.0, 100.0);
  const auto sightings = sightings_in(image, camera, street(false));
  ASSERT_FALSE(sightings.empty());
  for (const PaintSighting& sighting : sightings) EXPECT_EQ(sighting.candidates, 0);
}

/// How many of the places on the line of street(false) have paint in the picture.
int found_in(const GreyImage& image, const CameraModel& camera) {
  const auto sightings = sightings_in(image, camera, street(false));
  return static_cast<int>(std::ranges::count_if(
      sightings, [](const PaintSighting& sighting) { return sighting.candidates > 0; }));
}

TEST(FindPaint, TakesNoKerbForALine) {
  const CameraModel camera = front_camera();
  EXPECT_GT(found_in(picture_of_stripe(camera, 0.15, 80.0), camera), 10);
  EXPECT_GT(found_in(picture_of_stripe(camera, 0.15, 110.0), camera), 10);
  // A kerb of light stone between asphalt and a pavement, and between asphalt and dark soil.
  EXPECT_EQ(found_in(picture_of_stripe(camera, 0.15, 150.0), camera), 0);
  EXPECT_EQ(found_in(picture_of_stripe(camera, 0.15, 10.0), camera), 0);
}

TEST(FindPaint, TakesNothingWiderThanALine) {
  const CameraModel camera = front_camera();
  EXPECT_GT(found_in(picture_of_stripe(camera, 0.28, 80.0), camera), 10);
  EXPECT_EQ(found_in(picture_of_stripe(camera, 0.36, 80.0), camera), 0);
}

TEST(FindPaint, FindsTheEndsOfTheBarsOfACrossing) {
  const CameraModel camera = front_camera();
  const GreyImage image = picture_of_paint(camera, 100.0, 10.0);
  int found = 0;
  int agreeing = 0;
  for (const PaintSighting& sighting : sightings_in(image, camera, street(true))) {
    if (sighting.candidates == 0) continue;
    ++found;
    agreeing += sighting.point_m.y() < -2.3 && std::abs(sighting.offset_px[0]) < 0.5;
  }
  EXPECT_GT(found, 3);
  // The sides of the bars are edges, too.
  EXPECT_GE(agreeing, 0.8 * found);
}

TEST(ReferenceTrajectory, InterpolatesAndNamesABadLine) {
  const std::string header = "time_ns,x_m,y_m,yaw_deg\n";
  const auto read = ReferenceTrajectory::parse(header + "0,0,0,179\n100000000,1,2,-179\n", "r.csv");
  ASSERT_TRUE(read) << read.error().message;
  const auto pose = read->at(Time{} + std::chrono::milliseconds(50));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x_m, 0.5, 1e-9);
  EXPECT_NEAR(std::abs(pose->yaw_rad), radians(180.0), 1e-9);
  EXPECT_FALSE(read->at(Time{} + std::chrono::seconds(1)));
  EXPECT_EQ(ReferenceTrajectory::parse(read->to_csv(), "again")->poses().size(), 2U);
  const auto bad = ReferenceTrajectory::parse(header + "0,0,0,1\n5,zero,0,1\n", "r.csv");
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().message.find("r.csv:3: found \"5,zero,0,1\""), std::string::npos);
  EXPECT_FALSE(ReferenceTrajectory::parse(header + "5,0,0,1\n5,0,0,1\n", "r.csv"));
  EXPECT_FALSE(ReferenceTrajectory::parse("x\n", "r.csv"));
}

}  // namespace
}  // namespace bevloc
