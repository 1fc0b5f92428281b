#include "pipeline/map/lanelet2_reader.h"

#include <GeographicLib/UTMUPS.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"

namespace bevloc {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::filesystem::path kFixtures =
    std::filesystem::path(BEVLOC_SOURCE_DIR) / "tests/pipeline/map/fixtures";

/// The map in a text, or an empty one, and a failure of the test, if it cannot be read.
HdMap lanelet_map(const std::string& text, const std::filesystem::path& file) {
  const auto imported = parse_lanelet2(text, file, {});
  EXPECT_TRUE(imported.has_value()) << imported.error().message;
  return imported ? imported->map : HdMap{};
}

HdMap read_fixture(const char* name) {
  const auto text = read_file(kFixtures / name);
  EXPECT_TRUE(text.has_value()) << text.error().message;
  return lanelet_map(text.value_or(""), name);
}

std::string read_error(const std::string& text) {
  const auto map = parse_lanelet2(text, "town.osm", {});
  EXPECT_FALSE(map.has_value());
  return map ? "" : map.error().message;
}

std::vector<const MapElement*> of_class(const HdMap& map, ElementClass element_class) {
  std::vector<const MapElement*> found;
  for (const MapElement& element : map.elements) {
    if (element.element_class == element_class) found.push_back(&element);
  }
  return found;
}

TEST(Lanelet2Reader, ClassifiesLinesByTagAndRole) {
  const HdMap map = read_fixture("street.osm");
  EXPECT_EQ(map.name, "street");
  const auto dividers = of_class(map, ElementClass::kLaneDivider);
  ASSERT_EQ(dividers.size(), 2U);
  EXPECT_EQ(dividers[0]->appearance, Appearance::kDashed);
  EXPECT_EQ(dividers[1]->appearance, Appearance::kSolid) << "bounds no lanelet";
  const auto boundaries = of_class(map, ElementClass::kRoadBoundary);
  ASSERT_EQ(boundaries.size(), 2U);
  EXPECT_EQ(boundaries[0]->appearance, Appearance::kKerb);
  EXPECT_EQ(boundaries[1]->appearance, Appearance::kUnknown);
}

TEST(Lanelet2Reader, TheMapFrameIsTheTangentPlaneAtTheMiddle) {
  const HdMap map = read_fixture("street.osm");
  EXPECT_NEAR(map.origin.latitude_deg, 48.99995, 1e-12);
  EXPECT_NEAR(map.origin.longitude_deg, 8.001, 1e-12);
  const auto& divider = of_class(map, ElementClass::kLaneDivider)[0]->points;
  // One thousandth of a degree at 49 degrees north is 73.1 m east; half of 1e-4 is 5.56 m north.
  ASSERT_EQ(divider.size(), 2U);
  EXPECT_NEAR(divider[0].x(), -73.17, 0.02);
  EXPECT_NEAR(divider[0].y(), 5.56, 0.01);
  EXPECT_NEAR(divider[1].x(), 0.0, 1e-9);
}

TEST(Lanelet2Reader, ACrossingIsTheAreaBetweenItsBoundsInEitherDirection) {
  const HdMap map = read_fixture("street.osm");
  const auto crossings = of_class(map, ElementClass::kPedestrianCrossing);
  ASSERT_EQ(crossings.size(), 1U);
  EXPECT_EQ(crossings[0]->appearance, Appearance::kZebra);
  const auto& ring = crossings[0]->points;
  ASSERT_EQ(ring.size(), 4U);
  double area = 0.0;
  for (size_t i = 0; i < 4; ++i) {
    const auto& a = ring[i];
    const auto& b = ring[(i + 1) % 4];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  // 3.66 m by 22.24 m. A ring that crosses itself would have no area.
  EXPECT_NEAR(std::abs(area), 81.4, 0.5);
}

TEST(Lanelet2Reader, LanesHaveTheirBoundsInDrivingDirection) {
  const HdMap map = read_fixture("street.osm");
  ASSERT_EQ(map.lanes.size(), 4U);
  const Lane& eastbound = map.lanes[0];
  EXPECT_GT(eastbound.centerline.back().x(), eastbound.centerline.front().x());
  EXPECT_GT(eastbound.left.front().y(), eastbound.right.front().y());
  EXPECT_NEAR(eastbound.speed_limit_mps, 30.0 / 3.6, 1e-9);
  const Lane& westbound = map.lanes[1];
  EXPECT_LT(westbound.centerline.back().x(), westbound.centerline.front().x());
  EXPECT_LT(westbound.left.back().x(), westbound.left.front().x());
  EXPECT_LT(westbound.left.front().y(), westbound.right.front().y());
  for (const Lane& lane : map.lanes) {
    for (size_t i = 0; i + 1 < lane.centerline.size(); ++i) {
      EXPECT_LE((lane.centerline[i + 1] - lane.centerline[i]).norm(), 2.001);
    }
  }
}

TEST(Lanelet2Reader, LanesFollowEachOtherWhereBothBoundsMeet) {
  const HdMap map = read_fixture("street.osm");
  // Lane 0 is eastbound, 1 westbound; 2 and 3 continue in the east in both directions.
  EXPECT_THAT(map.lanes[0].successors, ElementsAre(2U));
  EXPECT_THAT(map.lanes[1].successors, IsEmpty());
  EXPECT_THAT(map.lanes[2].successors, IsEmpty());
  EXPECT_THAT(map.lanes[3].successors, IsEmpty());
}

TEST(Lanelet2Reader, AutowareLocalCoordinatesReplaceMissingAngles) {
  const HdMap map = read_fixture("autoware.osm");
  ASSERT_EQ(map.lanes.size(), 1U);
  EXPECT_EQ(map.lanes[0].right.front(), Eigen::Vector2d(-20.0, -4.0)) << "from the middle";
  EXPECT_NEAR(map.lanes[0].speed_limit_mps, 50.0 / 3.6, 1e-9);
  EXPECT_EQ(of_class(map, ElementClass::kRoadBoundary).size(), 2U) << "the edges of the road";
  EXPECT_EQ(map.origin.latitude_deg, 0.0);
}

/// A lanelet with two straight bounds. `nodes` contains attributes and tags of its four nodes.
std::string lanelet_of(const std::vector<std::string>& nodes) {
  std::string text = "<osm>\n";
  for (size_t i = 0; i < nodes.size(); ++i) {
    text += fmt::format("<node id='{}' {}</node>\n", i + 1, nodes[i]);
  }
  return text +
         "<way id='10'><nd ref='1'/><nd ref='2'/><tag k='type' v='road_border'/></way>\n"
         "<way id='11'><nd ref='3'/><nd ref='4'/><tag k='type' v='line_thick'/></way>\n"
         "<relation id='20'><member type='way' role='left' ref='11'/>"
         "<member type='way' role='right' ref='10'/><tag k='type' v='lanelet'/></relation>\n"
         "</osm>\n";
}

TEST(Lanelet2Reader, LocalCoordinatesOfAnotherGridAreRotatedIntoTheTangentPlane) {
  // UTM coordinates three degrees from the central meridian, where the grid is rotated by 2.3
  // degrees.
  std::vector<std::string> nodes;
  const std::vector<std::pair<double, double>> places = {
      {49.0, 11.99}, {49.0, 11.992}, {49.001, 11.99}, {49.001, 11.992}};
  for (const auto& [latitude, longitude] : places) {
    int zone = 0;
    bool north = true;
    double x = 0.0, y = 0.0;
    GeographicLib::UTMUPS::Forward(latitude, longitude, zone, north, x, y);
    nodes.push_back(
        fmt::format("lat='{}' lon='{}'><tag k='local_x' v='{}'/><tag k='local_y' v='{}'/>",
                    latitude, longitude, std::fmod(x, 1e5), std::fmod(y, 1e5)));
  }
  const HdMap map = lanelet_map(lanelet_of(nodes), "grid.osm");
  ASSERT_EQ(map.lanes.size(), 1U);
  EXPECT_NEAR(map.origin.latitude_deg, 49.0005, 1e-9);
  const auto& south = map.lanes[0].right;
  EXPECT_NEAR(south.front().y(), south.back().y(), 0.02);
  EXPECT_NEAR(std::abs(south.front().x() - south.back().x()), 146.3, 0.1);
}

/// Without the refusal the map would lie at latitude and longitude 0 without a word.
TEST(Lanelet2Reader, RefusesLocalCoordinatesThatContradictTheAngles) {
  std::vector<std::string> nodes;
  for (const auto& [x, y] : std::vector<std::pair<int, int>>{{0, 0}, {20, 0}, {0, 4}, {20, 4}}) {
    nodes.push_back(fmt::format(
        "lat='35.{}' lon='139.{}'><tag k='local_x' v='{}'/><tag k='local_y' v='{}'/>", y, x, x, y));
  }
  EXPECT_THAT(
      read_error(lanelet_of(nodes)),
      AllOf(StartsWith("town.osm:"),
            HasSubstr(": found local_x and local_y that differ from lat and lon by a scale of "),
            HasSubstr("wanted at most 1.01 and 1 m; correct this node")));
}

TEST(Lanelet2Reader, RefusesTwoKindsOfCoordinatesThatNothingRelates) {
  const std::string both = "lat='49' lon='8'><tag k='local_x' v='3'/><tag k='local_y' v='4'/>";
  const std::string angles = "lat='49' lon='8.001'>";
  const std::string local = "lat='' lon=''><tag k='local_x' v='3'/><tag k='local_y' v='9'/>";
  EXPECT_THAT(read_error(lanelet_of({angles, angles, local, local})),
              HasSubstr("both at 0 places"));
  EXPECT_THAT(read_error(lanelet_of({both, angles, local, local})), HasSubstr("both at 1 places"));
  EXPECT_THAT(read_error(lanelet_of({both, both, local, local})), HasSubstr("both at 1 places"));
}

TEST(Lanelet2Reader, LeavesOutFarPlaces) {
  const auto left_out_at = [](double second_x) {
    const auto at = [](double x, double y) {
      return fmt::format("lat='' lon=''><tag k='local_x' v='{}'/><tag k='local_y' v='{}'/>", x, y);
    };
    const HdMap map =
        lanelet_map(lanelet_of({at(0, 0), at(second_x, 0), at(0, 4), at(20, 4)}), "town.osm");
    EXPECT_EQ(map.elements.size(), 1U) << "the other line stays";
    return map.left_out;
  };
  EXPECT_THAT(left_out_at(2e5),
              Contains(HasSubstr(
                  "node 2: found a place (200000, 0) m from the origin, wanted at most 83000")));
  EXPECT_THAT(left_out_at(6e4),
              ElementsAre(HasSubstr("way 10: found 60000 m in this bound of lanelet 20, wanted at "
                                    "most 50000"),
                          HasSubstr("way 10: found 60000 m, wanted at most 50000")));
  EXPECT_THAT(read_error(lanelet_of({"lat='49' lon='8'>", "lat='52' lon='8'>",
                                     "lat='49' lon='8.1'>", "lat='52' lon='8.1'>"})),
              HasSubstr("m from the origin, wanted at most 83000"));
}

TEST(Lanelet2Reader, LaneletsForOtherParticipantsAreNoLanes) {
  const std::vector<std::string> nodes = {"lat='49' lon='8'>", "lat='49' lon='8.001'>",
                                          "lat='49.0001' lon='8'>", "lat='49.0001' lon='8.001'>"};
  for (const char* tag : {"<tag k='subtype' v='bicycle_lane'/>", "<tag k='subtype' v='walkway'/>",
                          "<tag k='subtype' v='road'/><tag k='participant:bicycle' v='yes'/>"}) {
    std::string text = lanelet_of(nodes);
    text.insert(text.find("</relation>"), tag);
    const HdMap map = lanelet_map(text, "town.osm");
    EXPECT_THAT(map.lanes, IsEmpty()) << tag;
    EXPECT_EQ(map.elements.size(), 1U) << tag;
  }
}

TEST(Lanelet2Reader, ErrorsNameLineAndElement) {
  EXPECT_THAT(read_error("<osm>\n<node id='1'\n"),
              StartsWith("town.osm:2: found text that is not XML"));
  EXPECT_THAT(read_error(""), HasSubstr("not XML"));
  EXPECT_THAT(read_error("<kml>\n</kml>"), HasSubstr("town.osm:1: found <kml>"));
  EXPECT_THAT(read_error("<osm>\n\n<node id='x1' lat='1' lon='1'/></osm>"),
              StartsWith("town.osm:3: node: found id=\"x1\", wanted a whole number"));
  EXPECT_THAT(
      read_error("<osm>\n<node id='1' lat='1' lon='1'/>\n<node id='1' lat='2' lon='2'/></osm>"),
      StartsWith("town.osm:3: node 1: found this id a second time"));
  EXPECT_THAT(read_error("<osm></osm>"), HasSubstr("found no lanelet"));
}

TEST(Lanelet2Reader, RefusesBadCoordinates) {
  const auto error_with = [](const std::string& node) {
    return read_error("<osm>\n<node id='-7' " + node + "</node></osm>");
  };
  EXPECT_EQ(error_with("lat='90.5' lon='8'>"),
            "town.osm:2: node -7: found lat \"90.5\", wanted a number from -90 to 90");
  EXPECT_THAT(error_with("lat='9' lon='-181'>"), HasSubstr("found lon \"-181\""));
  EXPECT_THAT(error_with("lat='nan' lon='8'>"), HasSubstr("found lat \"nan\""));
  EXPECT_THAT(error_with("lat='inf' lon='8'>"), HasSubstr("found lat \"inf\""));
  EXPECT_THAT(error_with("lat='49,5' lon='8'>"), HasSubstr("found lat \"49,5\""));
  EXPECT_THAT(error_with("lat='1' lon='8'>\n<tag k='local_x' v='far'/>"),
              StartsWith("town.osm:3: node -7: found local_x \"far\""));
}

/// What was left out of a map of one lanelet after a change of its text.
std::vector<std::string> left_out_with(const std::string& from, const std::string& to) {
  std::string text = lanelet_of({"lat='49' lon='8'>", "lat='49' lon='8.001'>",
                                 "lat='49.0001' lon='8'>", "lat='49.0001' lon='8.001'>"});
  text.replace(text.find(from), from.size(), to);
  const HdMap map = lanelet_map(text, "town.osm");
  EXPECT_THAT(map.lanes, IsEmpty());
  return map.left_out;
}

TEST(Lanelet2Reader, LeavesOutWhatIsBrokenAndNamesIt) {
  EXPECT_THAT(
      left_out_with("<nd ref='2'/>", "<nd ref='99'/>"),
      Contains(StartsWith("town.osm:6: way 10: found a reference to node 99, which is missing")));
  EXPECT_THAT(left_out_with("role='left' ref='11'", "role='left' ref='98'"),
              ElementsAre(StartsWith(
                  "town.osm:8: lanelet 20: found a reference to way 98, which is missing")));
  EXPECT_THAT(left_out_with("role='left'", "role='centre'"),
              ElementsAre(HasSubstr("lanelet 20: found no way of role left")));
  EXPECT_THAT(left_out_with("role='right'", "role='left'"),
              ElementsAre(HasSubstr("found 2 ways of role left that do not join")));
  EXPECT_THAT(left_out_with("<nd ref='3'/>", ""),
              ElementsAre(HasSubstr("found 1 points in this bound")));
  EXPECT_THAT(left_out_with("lat='49.0001' lon='8'", "lat='' lon='8'"),
              Contains(StartsWith("town.osm:4: node 3: found no coordinates")));
}

TEST(Lanelet2Reader, RefusesAMapOfWhichNothingIsLeft) {
  std::string text = lanelet_of({"lat='49' lon='8'>", "lat='49' lon='8.001'>",
                                 "lat='49.0001' lon='8'>", "lat='49.0001' lon='8.001'>"});
  for (const std::string_view node : {"<nd ref='2'/>", "<nd ref='4'/>"}) {
    text.replace(text.find(node), node.size(), "<nd ref='99'/>");
  }
  EXPECT_THAT(read_error(text), AllOf(StartsWith("town.osm:7: way 11"),
                                      HasSubstr("nothing else in the file can be used")));
}

/// Text of a map in local coordinates.
class MapText {
 public:
  /// A straight way along x. `tags`: pairs of key and value.
  MapText& way(int id, double from_x, double to_x, double y, const std::string& type) {
    const int first = 10 * id;
    for (const auto& [node, x] : {std::pair(first, from_x), std::pair(first + 1, to_x)}) {
      nodes_ += fmt::format(
          "<node id='{}' lat='' lon=''><tag k='local_x' v='{}'/><tag k='local_y' v='{}'/></node>\n",
          node, x, y);
    }
    const std::string tag = type.empty() ? "" : fmt::format("<tag k='type' v='{}'/>", type);
    ways_ += fmt::format("<way id='{}'><nd ref='{}'/><nd ref='{}'/>{}</way>\n", id, first,
                         first + 1, tag);
    return *this;
  }

  MapText& lanelet(int id, const std::vector<int>& left, const std::vector<int>& right) {
    relations_ += fmt::format("<relation id='{}'><tag k='type' v='lanelet'/>", id);
    for (const int way : left)
      relations_ += fmt::format("<member type='way' role='left' ref='{}'/>", way);
    for (const int way : right)
      relations_ += fmt::format("<member type='way' role='right' ref='{}'/>", way);
    relations_ += "</relation>\n";
    return *this;
  }

  HdMap read() const {
    return lanelet_map("<osm>\n" + nodes_ + ways_ + relations_ + "</osm>", "text.osm");
  }

 private:
  std::string nodes_;
  std::string ways_;
  std::string relations_;
};

TEST(Lanelet2Reader, ABoundMayBeSeveralWaysInAnyOrderAndDirection) {
  MapText text;
  text.way(1, 0, 60, 3.5, "virtual");
  text.way(2, 20, 40, 0, "curbstone").way(3, 20, 0, 0, "guard_rail").way(4, 60, 40, 0, "fence");
  const HdMap map = text.lanelet(20, {1}, {2, 3, 4}).read();
  ASSERT_EQ(map.lanes.size(), 1U);
  EXPECT_THAT(map.left_out, IsEmpty());
  EXPECT_EQ(map.lanes[0].right.front(), Eigen::Vector2d(0, 0));
  EXPECT_EQ(map.lanes[0].right.back(), Eigen::Vector2d(60, 0));
  EXPECT_EQ(map.lanes[0].right.size(), 4U);
  std::vector<Appearance> appearances;
  for (const MapElement* element : of_class(map, ElementClass::kRoadBoundary)) {
    appearances.push_back(element->appearance);
  }
  EXPECT_THAT(appearances,
              ElementsAre(Appearance::kKerb, Appearance::kGuardRail, Appearance::kFence))
      << "each piece has its own type";
}

TEST(Lanelet2Reader, KeepsDividersThatBoundNoLanelet) {
  MapText text;
  text.way(1, 0, 60, 7, "curbstone").way(2, 0, 60, 0, "curbstone").way(3, 0, 60, 3.5, "line_thin");
  const HdMap map = text.lanelet(20, {1}, {2}).read();
  EXPECT_EQ(of_class(map, ElementClass::kLaneDivider).size(), 1U);
}

TEST(Lanelet2Reader, AnOuterLineIsTheEdgeOfTheRoadWhereNothingElseIs) {
  MapText text;
  text.way(1, 0, 60, 3.5, "line_thin").way(2, 0, 60, 0, "line_thin").way(3, 0, 60, 7, "line_thin");
  text.way(4, 0, 60, -1.5, "curbstone");
  const HdMap map = text.lanelet(20, {1}, {2}).lanelet(21, {3}, {1}).read();
  const auto boundaries = of_class(map, ElementClass::kRoadBoundary);
  ASSERT_EQ(boundaries.size(), 2U) << "the kerb, and the line without a kerb";
  EXPECT_EQ(boundaries[0]->points.front().y(), 7.0);
  EXPECT_EQ(boundaries[0]->appearance, Appearance::kRoadEdge);
  EXPECT_EQ(of_class(map, ElementClass::kLaneDivider).size(), 2U)
      << "the middle, and the line beside the kerb";
}

TEST(Lanelet2Reader, WithoutTypesNeighboursNeedNotShareAWay) {
  MapText text;
  text.way(1, 0, 60, 7, "").way(2, 0, 60, 3.5, "").way(3, 0, 60, 3.6, "").way(4, 0, 60, 0, "");
  const HdMap map = text.lanelet(20, {1}, {2}).lanelet(21, {3}, {4}).read();
  EXPECT_EQ(map.lanes.size(), 2U);
  EXPECT_EQ(of_class(map, ElementClass::kRoadBoundary).size(), 2U);
  const auto dividers = of_class(map, ElementClass::kLaneDivider);
  ASSERT_EQ(dividers.size(), 1U) << "the two bounds in the middle are one line";
  EXPECT_EQ(dividers[0]->points.front().y(), 3.5);
}

TEST(Lanelet2Reader, TheOrderOfNeighboursInTheFileDoesNotMatter) {
  MapText text;
  text.way(4, 0, 60, 7, "").way(3, 0, 60, 3.5, "").way(2, 0, 60, 3.6, "").way(1, 0, 60, 0, "");
  const HdMap map = text.lanelet(20, {4}, {3}).lanelet(21, {2}, {1}).read();
  EXPECT_EQ(of_class(map, ElementClass::kLaneDivider).size(), 1U);
}

TEST(Lanelet2Reader, OneBadLaneletDoesNotLoseTheMap) {
  MapText text;
  text.way(1, 0, 60, 3.5, "line_thin").way(2, 0, 60, 0, "curbstone");
  const HdMap map = text.lanelet(20, {1}, {2}).lanelet(21, {1}, {}).lanelet(22, {7}, {2}).read();
  EXPECT_EQ(map.lanes.size(), 1U);
  EXPECT_THAT(map.left_out, ElementsAre(HasSubstr("lanelet 21"), HasSubstr("lanelet 22")));
}

}  // namespace
}  // namespace bevloc
