// Lane offsets, road marks and objects of OpenDRIVE that few files have.
#include <cmath>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/map/formats/opendrive_file.h"

namespace bevloc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using test::file_with;
using test::good;
using test::kLanes;
using test::kStraight;
using test::of;
using test::read;
using test::road_error;
using test::road_with;

/// A driving lane of 3.5 m with this mark at its outer border.
std::string wide_lane(int id, std::string_view mark = "") {
  return fmt::format(
      R"(<lane id="{}" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>{}</lane>)", id,
      mark);
}

/// A section with lanes 1 and -1 and these marks between them.
std::string two_lanes(std::string_view center_marks) {
  return fmt::format(R"(<laneSection s="0"><left>{}</left><center><lane id="0">{}</lane></center>
<right>{}</right></laneSection>)",
                     wide_lane(1), center_marks, wide_lane(-1));
}

std::string lane_offset(std::string_view start, double a_m) {
  return fmt::format(R"(<laneOffset s="{}" a="{}" b="0" c="0" d="0"/>)", start, a_m);
}

TEST(Opendrive, ALaneOffsetMayJumpWhereASectionBegins) {
  constexpr std::string_view kBroken = R"(<roadMark sOffset="0" type="broken"/>)";
  const std::string sections = two_lanes(kBroken) +
                               R"(<laneSection s="50"><center><lane id="0"/></center><right>)" +
                               wide_lane(-1, kBroken) + wide_lane(-2) + "</right></laneSection>";
  // 0.00001 m and 4 mm are rounding errors.
  for (const char* start : {"50", "49.99999", "50.00001", "49.996"}) {
    const std::string offsets = lane_offset("0", 0.0) + lane_offset(start, 3.5);
    const ImportedMap imported = good(file_with(road_with(kStraight, sections, "", offsets)));
    EXPECT_EQ(of(imported, ElementClass::kLaneDivider, Appearance::kDashed).size(), 2U) << start;
    EXPECT_EQ(of(imported, ElementClass::kRoadBoundary, Appearance::kRoadEdge).size(), 4U) << start;
    for (const MapElement& element : imported.map.elements) {
      const double y_m = element.element_class == ElementClass::kLaneDivider ? 0.0 : 3.5;
      for (const Eigen::Vector2d& point : element.points) {
        EXPECT_NEAR(std::abs(point.y()), y_m, 1e-9) << start;
        EXPECT_NEAR(point.y(), element.points[0].y(), 1e-9) << start;
      }
    }
    ASSERT_EQ(imported.map.lanes.size(), 4U) << start;
    EXPECT_THAT(imported.map.lanes[0].successors, ElementsAre(2)) << start;
  }
}

TEST(Opendrive, PaintLiesBesideItsBorderWhereTheFileSaysSo) {
  const ImportedMap imported = good(file_with(road_with(kStraight, two_lanes(R"(
    <roadMark sOffset="0" type="solid"><type name="a"><line sOffset="0" tOffset="-0.3"/></type>
    </roadMark>
    <roadMark sOffset="20" type="broken"><sway ds="10" a="0.5" b="0.01" c="0" d="0"/>
      <type name="b"><line sOffset="0" tOffset="0.1"/></type></roadMark>
    <roadMark sOffset="60" type="solid solid"><type name="c"><line sOffset="0" tOffset="0.2"/>
      <line sOffset="0" tOffset="-0.2"/></type></roadMark>)"))));
  const auto expect_line = [](const MapElement& line, const Eigen::Vector2d& from,
                              const Eigen::Vector2d& to) {
    EXPECT_NEAR((line.points.front() - from).norm(), 0.0, 1e-9);
    EXPECT_NEAR((line.points.back() - to).norm(), 0.0, 1e-9);
  };
  const auto solid = of(imported, ElementClass::kLaneDivider, Appearance::kSolid);
  ASSERT_EQ(solid.size(), 1U);
  expect_line(solid[0], {0, -0.3}, {20, -0.3});
  const auto dashed = of(imported, ElementClass::kLaneDivider, Appearance::kDashed);
  ASSERT_EQ(dashed.size(), 2U) << "the paint jumps where the sway begins";
  expect_line(dashed[0], {20, 0.1}, {30, 0.1});
  expect_line(dashed[1], {30, 0.6}, {60, 0.9});
  const auto twice = of(imported, ElementClass::kLaneDivider, Appearance::kDoubleSolid);
  ASSERT_EQ(twice.size(), 1U);
  expect_line(twice[0], {60, 0}, {100, 0});
}

/// A road with an object whose width is no number.
std::string with_wrong_object(std::string_view type) {
  return file_with(road_with(
      kStraight, kLanes,
      fmt::format(R"(<object id="3" type="{}" s="9" t="0" length="4" width="nan"/>)", type)));
}

TEST(Opendrive, ABadNumberOfAnObjectThatIsNotUsedIsLeftOut) {
  const size_t elements = good(file_with(road_with(kStraight, kLanes))).map.elements.size();
  const auto is_named = HasSubstr("<object>: found width=\"nan\", wanted a number from");
  const ImportedMap imported = good(with_wrong_object("tree"));
  EXPECT_EQ(imported.map.elements.size(), elements);
  EXPECT_THAT(imported.map.left_out, ElementsAre(is_named));
  EXPECT_THAT(road_error(with_wrong_object("crosswalk")), is_named);

  for (const std::string becomes : {"divider", "nothing"}) {
    const auto table = ClassTable::parse(
        "rules:\n  - kind: object tree\n    becomes: " + becomes + "\n", "t.yaml");
    ASSERT_TRUE(table.has_value()) << table.error().message;
    ImportOptions options;
    options.classes = &*table;
    const auto ruled = read(with_wrong_object("tree"), options);
    EXPECT_EQ(ruled.has_value(), becomes == "nothing");
    EXPECT_THAT(ruled ? ruled->map.left_out.at(0) : ruled.error().message, is_named);
  }
}

}  // namespace
}  // namespace bevloc
