// Where the asphalt of one OpenDRIVE road ends the edges of another one.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/lanelet_geometry.h"

namespace bevloc {
namespace {

using testing::DoubleNear;
using testing::UnorderedElementsAre;

struct StraightRoad {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
  double length_m = 100.0;
  std::string lanes{};
  std::string elevation{};
  int junction = -1;
};

std::string text_of_road(const StraightRoad& road) {
  return fmt::format(
      R"(<road id="7" length="{0}" junction="{1}"><planView>
<geometry s="0" x="{2}" y="{3}" hdg="{4}" length="{0}"><line/></geometry></planView>
{5}<lanes><laneSection s="0">{6}</laneSection></lanes></road>)",
      road.length_m, road.junction, road.x_m, road.y_m, road.heading_rad, road.elevation,
      road.lanes);
}

std::string straight_lane(int id, std::string_view type, double width_m,
                          std::string_view mark = "none") {
  return fmt::format(
      R"(<lane id="{}" type="{}"><width sOffset="0" a="{}" b="0" c="0" d="0"/>
<roadMark sOffset="0" type="{}"/></lane>)",
      id, type, width_m, mark);
}

std::string height_of(double height_m) {
  return fmt::format(
      R"(<elevationProfile><elevation s="0" a="{}" b="0" c="0" d="0"/></elevationProfile>)",
      height_m);
}

HdMap map_of_roads(const std::vector<StraightRoad>& roads) {
  std::string text = R"(<OpenDRIVE><header revMajor="1"/>)";
  for (const StraightRoad& road : roads) text += text_of_road(road);
  const auto imported = parse_imported(text + "</OpenDRIVE>", "roads.xodr", {});
  EXPECT_TRUE(imported.has_value()) << imported.error().message;
  return imported ? imported->map : HdMap{};
}

double length_of_class(const HdMap& map, ElementClass element_class) {
  double length_m = 0.0;
  for (const MapElement& element : map.elements) {
    if (element.element_class == element_class) length_m += polyline_length(element.points);
  }
  return length_m;
}

/// A road of 200 m to the east and one of 200 m to the north, with a painted left edge each.
HdMap crossing_roads(const std::string& first_elevation, const std::string& second_elevation) {
  StraightRoad east;
  east.x_m = -100.0;
  east.length_m = 200.0;
  east.lanes = "<left>" + straight_lane(1, "driving", 3.5, "solid") +
               R"(</left><center><lane id="0"/></center><right>)" +
               straight_lane(-1, "driving", 3.5) + "</right>";
  StraightRoad north = east;
  north.x_m = 0.0;
  north.y_m = -100.0;
  north.heading_rad = 1.5707963267948966;
  east.elevation = first_elevation;
  north.elevation = second_elevation;
  return map_of_roads({east, north});
}

TEST(Asphalt, ABridgeLeavesTheEdgesOfTheRoadBelow) {
  for (const double height_m : {8.0, -8.0}) {
    const HdMap map = crossing_roads(height_of(0.0), height_of(height_m));
    EXPECT_NEAR(length_of_class(map, ElementClass::kRoadBoundary), 4 * 200.0, 1e-6) << height_m;
    EXPECT_EQ(length_of_class(map, ElementClass::kLaneDivider), 0.0) << "an edge is no divider";
  }
}

TEST(Asphalt, RoadsOfOneHeightOpenTheEdgesOfEachOther) {
  // The four edges are open for 7 m each, up to the pieces of 0.5 m into which they are cut.
  for (const auto& [first, second] : std::vector<std::pair<std::string, std::string>>{
           {height_of(0.0), height_of(2.0)}, {height_of(0.0), ""}, {"", ""}}) {
    const HdMap map = crossing_roads(first, second);
    EXPECT_NEAR(length_of_class(map, ElementClass::kRoadBoundary), 4 * 193.0, 4.0);
  }
}

TEST(Asphalt, TheRoadsOfAJunctionKeepTheirMedians) {
  StraightRoad with_median;
  with_median.junction = 5;
  with_median.lanes = "<left>" + straight_lane(1, "median", 2.0) +
                      straight_lane(2, "driving", 3.5) +
                      R"(</left><center><lane id="0"/></center><right>)" +
                      straight_lane(-1, "driving", 3.5) + "</right>";
  // Its lane lies 2 m to the right of that of the first road.
  StraightRoad beside = with_median;
  beside.y_m = -5.5;
  beside.lanes =
      R"(<center><lane id="0"/></center><right>)" + straight_lane(-1, "driving", 3.5) + "</right>";
  std::vector<double> edges_m;
  for (const MapElement& element : map_of_roads({with_median, beside}).elements) {
    ASSERT_EQ(element.element_class, ElementClass::kRoadBoundary);
    EXPECT_NEAR(polyline_length(element.points), 100.0, 1e-6);
    edges_m.push_back(element.points.front().y());
  }
  const auto at = [](double y_m) { return DoubleNear(y_m, 1e-9); };
  EXPECT_THAT(edges_m, UnorderedElementsAre(at(5.5), at(2.0), at(0.0), at(-9.0)))
      << "both edges of the median, and the outer edges without the gap between the roads";
}

/// An area of 20 m by 10 m, and one of 20 m by 6 m whose first half lies within it.
std::string overlapping_areas(double second_height_m) {
  const auto area = [](int id, double x_m, double y_m, double width_m, double z_m) {
    return fmt::format(
        R"("{0}": {{"id": {0}, "area_boundary": [{{"x": {1}, "y": {2}, "z": {5}}},
{{"x": {3}, "y": {2}, "z": {5}}}, {{"x": {3}, "y": {4}, "z": {5}}}, {{"x": {1}, "y": {4}, "z": {5}}}]}})",
        id, x_m, y_m, x_m + 20.0, y_m + width_m, z_m);
  };
  return fmt::format(
      R"({{"lane_segments": {{}}, "pedestrian_crossings": {{}}, "drivable_areas": {{{}, {}}}}})",
      area(1, 0.0, 0.0, 10.0, 0.0), area(2, 10.0, 2.0, 6.0, second_height_m));
}

TEST(Asphalt, DrivableAreasAboveEachOtherHaveTheirOwnOutlines) {
  const auto outline_m = [](double second_height_m) {
    const auto imported = parse_imported(overlapping_areas(second_height_m), "map.json", {});
    EXPECT_TRUE(imported.has_value()) << imported.error().message;
    return imported ? length_of_class(imported->map, ElementClass::kRoadBoundary) : 0.0;
  };
  EXPECT_NEAR(outline_m(6.0), 60.0 + 52.0, 1e-6);
  EXPECT_NEAR(outline_m(1.0), 60.0 - 6.0 + 52.0 - 26.0, 1.0) << "the outline of both together";
}

}  // namespace
}  // namespace bevloc
