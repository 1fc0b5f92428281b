// Which coordinates of a Lanelet2 file count, and where its map frame lies.
#include "pipeline/map/map_frame.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <GeographicLib/LocalCartesian.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/lanelet2_reader.h"
#include "pipeline/map/tangent_plane.h"

namespace bevloc {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr std::string_view kZeroAngles = R"(lat="0" lon="0")";

/// A node with Autoware's coordinates, on a line of its own.
std::string local_node(int id, double x_m, double y_m, std::string_view square = "",
                       std::string_view angles = kZeroAngles) {
  const std::string code =
      square.empty() ? "" : fmt::format(R"(<tag k="mgrs_code" v="{}"/>)", square);
  return fmt::format(
             R"(<node id="{}" {}><tag k="local_x" v="{}"/><tag k="local_y" v="{}"/>{}</node>)", id,
             angles, x_m, y_m, code) +
         "\n";
}

/// A kerb through these nodes.
std::string kerb_through(int id, const std::vector<int>& nodes) {
  std::string text = fmt::format(R"(<way id="{}"><tag k="type" v="curbstone"/>)", id);
  for (const int node : nodes) text += fmt::format(R"(<nd ref="{}"/>)", node);
  return text + "</way>\n";
}

/// A map of kerbs. The first node is in line 2.
Result<ImportedMap> map_frame_of(const std::string& elements, const ImportOptions& options = {}) {
  return parse_lanelet2("<osm>\n" + elements + "</osm>", "frame.osm", options);
}

ImportedMap readable_frame(const std::string& elements, const ImportOptions& options = {}) {
  auto imported = map_frame_of(elements, options);
  EXPECT_TRUE(imported.has_value()) << imported.error().message;
  return imported ? std::move(*imported) : ImportedMap{};
}

/// A kerb of 50 m in Tokyo, without latitude and longitude, and further elements.
std::string kerb_in_tokyo(std::string_view more) {
  return local_node(1, 81'600, 50'100, "54SUE") + local_node(2, 81'650, 50'100, "54SUE") +
         kerb_through(11, {1, 2}) + std::string(more);
}

/// A node with both kinds of coordinates, this far from latitude 48 and longitude 11. Its local_x
/// may be wrong.
std::string located_node(int id, double east_m, double north_m, double error_m = 0.0) {
  const std::string angles = fmt::format(R"(lat="{:.9f}" lon="{:.9f}")", 48.0 + north_m / 111'195.0,
                                         11.0 + east_m / 74'625.0);
  return local_node(id, 5'000 + east_m + error_m, 5'000 + north_m, "", angles);
}

TEST(MapFrame, NodesWithoutAWayDoNotHideTheMgrsSquare) {
  for (const std::string& stray :
       {std::string(R"(<node id="9" lat="0" lon="0"/>)"),
        std::string(R"(<node id="9" lat="49" lon="8"/>)"), local_node(9, 0, 0)}) {
    const GeoOrigin origin = readable_frame(kerb_in_tokyo(stray)).map.origin;
    EXPECT_NEAR(origin.latitude_deg, 35.68, 0.01) << stray;
    EXPECT_NEAR(origin.longitude_deg, 139.69, 0.01) << stray;
  }
}

TEST(MapFrame, ALatitudeAndLongitudeOfZeroAreNoneBesideLocalCoordinates) {
  const HdMap map =
      readable_frame(kerb_in_tokyo(R"(<node id="9" lat="0" lon="0"/>)" + kerb_through(12, {1, 9})))
          .map;
  EXPECT_NEAR(map.origin.latitude_deg, 35.68, 0.01);
  EXPECT_EQ(map.elements.size(), 1U);
  EXPECT_THAT(map.left_out, Contains(HasSubstr("node 9: found no coordinates")));
}

TEST(MapFrame, OnlyNodesOfWaysMustFitTheAngles) {
  const std::string kerb =
      located_node(1, 0, 0) + located_node(2, 100, 0) + kerb_through(11, {1, 2});
  const HdMap map = readable_frame(kerb + located_node(9, 40, 40, 300)).map;
  ASSERT_EQ(map.elements.size(), 1U);
  EXPECT_NEAR((map.elements[0].points[1] - map.elements[0].points[0]).norm(), 100.0, 0.5);
}

TEST(MapFrame, NamesTheNodeThatDoesNotFitTheAngles) {
  // A gross error pulls the fit to the wrong node, so that all others are farther from it.
  for (const double error_m : {20.0, 300.0, 100'000.0}) {
    std::string elements;
    for (int id = 1; id <= 5; ++id) {
      elements += located_node(id, 50.0 * id, id % 2, id == 3 ? error_m : 0.0);
    }
    const auto map = map_frame_of(elements + kerb_through(11, {1, 2, 3, 4, 5}));
    ASSERT_FALSE(map.has_value()) << error_m;
    EXPECT_THAT(map.error().message,
                AllOf(StartsWith("frame.osm:4: node 3: found local_x and local_y that differ"),
                      HasSubstr("; correct this node, which fits worst, or remove local_x and")));
  }
}

TEST(MapFrame, BlanksInAnMgrsCodeDoNotCount) {
  const ImportedMap imported =
      readable_frame(local_node(1, 81'600, 50'100, "54S UE 81600 50100") +
                     local_node(2, 81'650, 50'100, " 54SUE8165050100") + kerb_through(11, {1, 2}));
  EXPECT_NEAR(imported.map.origin.latitude_deg, 35.68, 0.01);
  EXPECT_NEAR(imported.map.origin.longitude_deg, 139.69, 0.01);
  EXPECT_THAT(imported.report.remarks(), IsEmpty());
}

TEST(MapFrame, AnMgrsCodeWithoutASquareIsNamed) {
  const ImportedMap imported =
      readable_frame(local_node(1, 81'600, 50'100, "54SUE8160050100") +
                     local_node(2, 81'650, 50'100, "UE8165050100") + kerb_through(11, {1, 2}));
  EXPECT_FALSE(is_known(imported.map.origin));
  EXPECT_THAT(imported.report.remarks(),
              Contains(StartsWith("frame.osm:3: node 2: found an mgrs_code of the square \"UE\"")));
}

TEST(MapFrame, ASquareGoesOnBeyondItsBorder) {
  const auto points_of_kerb = [](const std::vector<Eigen::Vector2d>& local_m) {
    std::string elements;
    std::vector<int> ids;
    for (const Eigen::Vector2d& point : local_m) {
      ids.push_back(static_cast<int>(ids.size()) + 1);
      elements += local_node(ids.back(), point.x(), point.y(), "54SUE");
    }
    const HdMap map = readable_frame(elements + kerb_through(11, ids)).map;
    EXPECT_THAT(map.left_out, IsEmpty());
    EXPECT_TRUE(is_known(map.origin));
    return map.elements.empty() ? std::vector<Eigen::Vector2d>{} : map.elements[0].points;
  };
  const auto east = points_of_kerb({{99'950, 50'000}, {100'000, 50'000}, {100'050, 50'000}});
  ASSERT_EQ(east.size(), 3U);
  EXPECT_NEAR((east[2] - east[0]).norm(), 100.0, 0.1);
  const auto south = points_of_kerb({{50'000, 50}, {50'000, -50}});
  ASSERT_EQ(south.size(), 2U);
  EXPECT_NEAR((south[1] - south[0]).norm(), 100.0, 0.1);
}

TEST(MapFrame, WholeCoordinatesOfUtmLieInTheirSquare) {
  const GeoOrigin within = readable_frame(kerb_in_tokyo("")).map.origin;
  const GeoOrigin whole =
      readable_frame(local_node(1, 381'600, 3'950'100, "54SUE") +
                     local_node(2, 381'650, 3'950'100, "54SUE") + kerb_through(11, {1, 2}))
          .map.origin;
  EXPECT_NEAR(whole.latitude_deg, within.latitude_deg, 1e-9);
  EXPECT_NEAR(whole.longitude_deg, within.longitude_deg, 1e-9);
}

TEST(MapFrame, EachNodeMayNameItsOwnSquare) {
  const HdMap map =
      readable_frame(local_node(1, 99'950, 50'000, "54SUE") + local_node(2, 50, 50'000, "54SVE") +
                     local_node(3, 100'100, 50'000, "54SVE") + kerb_through(11, {1, 2, 3}))
          .map;
  ASSERT_EQ(map.elements.size(), 1U);
  const auto& points = map.elements[0].points;
  EXPECT_NEAR((points[1] - points[0]).norm(), 100.0, 0.1);
  EXPECT_NEAR((points[2] - points[1]).norm(), 50.0, 0.1) << "100 km belong to one square only";
}

/// A kerb along x through these places, all of them at the same y.
std::string local_kerb(int id, const std::vector<double>& xs_m, double y_m) {
  std::string elements;
  std::vector<int> ids;
  for (const double x_m : xs_m) {
    ids.push_back(10 * id + static_cast<int>(ids.size()));
    elements += local_node(ids.back(), x_m, y_m);
  }
  return elements + kerb_through(id, ids);
}

TEST(MapFrame, LocalCoordinatesFarFromZeroAreCountedFromTheMiddle) {
  struct Case {
    std::string elements;
    size_t count;
  };
  for (const auto& [elements, count] : std::vector<Case>{
           {local_kerb(1, {82'960, 83'040}, 50'000), 1},
           {local_kerb(1, {25'000, 25'080}, 0), 1},
           {local_kerb(1, {10'000, 10'050, 10'100}, 0) + local_kerb(2, {83'040, 83'100}, 0), 2}}) {
    const ImportedMap imported = readable_frame(elements);
    EXPECT_EQ(imported.map.elements.size(), count);
    EXPECT_THAT(imported.map.left_out, IsEmpty());
    EXPECT_THAT(imported.report.remarks(), Contains(HasSubstr("all coordinates were shifted by")));
    ASSERT_FALSE(imported.map.elements.empty());
    EXPECT_LT(imported.map.elements[0].points[0].norm(), 200.0);
  }
}

TEST(MapFrame, LocalCoordinatesNearZeroStay) {
  // One place is so far away that no shift helps it.
  const ImportedMap imported =
      readable_frame(local_kerb(1, {19'000, 19'080}, 0) + local_kerb(2, {19'000, 200'000}, 5));
  ASSERT_EQ(imported.map.elements.size(), 1U);
  EXPECT_EQ(imported.map.elements[0].points[1], Eigen::Vector2d(19'080, 0));
  EXPECT_THAT(imported.map.left_out, Contains(HasSubstr("(200000, 5) m from the origin")));
  EXPECT_THAT(imported.report.remarks(), IsEmpty());
}

TEST(MapFrame, AnOriginFarFromTheLocalCoordinatesMovesTheFrame) {
  ImportOptions options;
  options.origin = GeoOrigin{49.0, 8.4};
  const ImportedMap far = readable_frame(local_kerb(1, {82'900, 82'960, 83'040}, 70), options);
  ASSERT_EQ(far.map.elements.size(), 1U);
  EXPECT_THAT(far.map.left_out, IsEmpty());
  const GeographicLib::LocalCartesian given(49.0, 8.4);
  const GeographicLib::LocalCartesian own(far.map.origin.latitude_deg,
                                          far.map.origin.longitude_deg);
  const std::vector<Eigen::Vector2d>& points = far.map.elements[0].points;
  for (const auto& [index, x_m] : {std::pair<size_t, double>{0, 82'900}, {2, 83'040}}) {
    const Eigen::Vector2d place = point_of(given, place_of(own, points.at(index)));
    EXPECT_LT((place - Eigen::Vector2d(x_m, 70)).norm(), 0.001);
  }
  EXPECT_THAT(far.report.remarks(),
              Contains(AllOf(HasSubstr("83.0 km from (0, 0), so x must point to true east"),
                             HasSubstr("add the tag mgrs_code"))));
  const ImportedMap near = readable_frame(local_kerb(1, {0, 80}, 0), options);
  EXPECT_THAT(near.report.remarks(), Not(Contains(HasSubstr("true east"))));
  EXPECT_EQ(near.map.origin.latitude_deg, 49.0);
}

}  // namespace
}  // namespace bevloc
