#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "evaluation/maps/map_command.h"
#include "evaluation/maps/map_diff.h"
#include "evaluation/maps/map_facts.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/map_loader.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kStreet =
    std::string(BEVLOC_SOURCE_DIR) + "/tests/pipeline/map/fixtures/street.osm";

HdMap road() {
  HdMap map;
  map.origin = {49.0, 8.4};
  map.elements = {{ElementClass::kRoadBoundary, Appearance::kKerb, {{-50, 4}, {50, 4}}},
                  {ElementClass::kLaneDivider, Appearance::kDashed, {{-50, 0}, {50, 0}}},
                  {ElementClass::kPedestrianCrossing,
                   Appearance::kZebra,
                   {{9, -4}, {12, -4}, {12, 4}, {9, 4}}}};
  map.lanes = {{{{-50, 4}, {50, 4}}, {{-50, 0}, {50, 0}}, {{-50, 2}, {50, 2}}, {}, 13.9}};
  return map;
}

Status run(const std::vector<std::string>& words) {
  return test::run_command<MapCommand>(words);
}

TEST(MapFacts, CountsByClass) {
  const MapFacts facts = facts_of(road());
  EXPECT_EQ(facts.classes[1].elements, 1U);
  EXPECT_DOUBLE_EQ(facts.classes[1].length_m, 22.0) << "with the closing edge";
  EXPECT_DOUBLE_EQ(facts.classes[2].length_m, 100.0);
  EXPECT_DOUBLE_EQ(facts.lanes_m, 100.0);
  EXPECT_EQ(facts.high, Eigen::Vector2d(50.0, 4.0));
}

TEST(MapFacts, NamesThePlaceOnEarth) {
  HdMap map = road();
  EXPECT_THAT(text_of(facts_of(map)), HasSubstr("origin 49.0000000, 8.4000000; 100 m x 8 m"));
  map.origin = {};
  EXPECT_THAT(text_of(facts_of(map)), HasSubstr("origin unknown; 100 m x 8 m"));
}

TEST(MapFacts, NamesFaults) {
  HdMap map = road();
  EXPECT_TRUE(faults_of(map).empty());
  map.elements.push_back(map.elements[0]);
  map.elements.push_back({ElementClass::kLaneDivider, Appearance::kSolid, {{0, 10}, {0.05, 10}}});
  map.lanes.push_back({{{0, 90}, {99, 90}}, {{0, 86}, {99, 86}}, {{0, 88}, {99, 88}}, {}, 13.9});
  const auto faults = faults_of(map);
  ASSERT_EQ(faults.size(), 3U);
  EXPECT_EQ(faults[0], "1 element is shorter than 0.1 m: 4");
  EXPECT_EQ(faults[1], "1 element lies on another one of its class: 3");
  EXPECT_THAT(faults[2], HasSubstr("99 of 199 m of lanes have no line within 15 m: lanes 1"));
}

TEST(MapFacts, NamesTheShorterOfTwoLinesInAnyOrder) {
  const MapElement part{ElementClass::kRoadBoundary, Appearance::kKerb, {{-20, 4}, {20, 4}}};
  HdMap map = road();
  map.elements.push_back(part);
  EXPECT_THAT(faults_of(map), ElementsAre("1 element lies on another one of its class: 3"));
  map = road();
  map.elements.insert(map.elements.begin(), part);
  EXPECT_THAT(faults_of(map), ElementsAre("1 element lies on another one of its class: 0"));
  map.elements.insert(map.elements.begin(), part);
  EXPECT_THAT(faults_of(map), ElementsAre("2 elements lie on another one of their class: 0, 1"));
}

TEST(MapDiff, FindsWhatOnlyOneMapHasInAnotherFrame) {
  const HdMap first = road();
  HdMap second = road();
  second.origin.longitude_deg += 0.001;  // 73.2 m to the east
  for (MapElement& element : second.elements) {
    for (Eigen::Vector2d& point : element.points) point.x() -= 73.19;
  }
  MapDiff same = compare(first, second);
  EXPECT_LT(same.classes[0].only_first_m + same.classes[0].only_second_m, 2.1);
  for (Eigen::Vector2d& point : second.elements[1].points) point.y() += 1.0;
  same = compare(first, second);
  EXPECT_DOUBLE_EQ(same.classes[0].only_first_m, same.classes[0].first_m);
  EXPECT_NEAR(same.classes[0].only_second_m, 100.0, 1e-6);
  EXPECT_LT(same.classes[2].only_first_m, 2.1) << "the boundary has not moved";
}

TEST(MapDiff, RefusesMapsThatLieTooFarApart) {
  const HdMap first = road();
  HdMap second = road();
  second.origin.latitude_deg += 0.7;  // 78 km
  EXPECT_TRUE(check_near(first, second));
  second.origin.latitude_deg = first.origin.latitude_deg + 2.0;
  const Status far = check_near(first, second);
  ASSERT_FALSE(far);
  EXPECT_THAT(far.error().message, HasSubstr("origins are 222 km apart, wanted at most 83 km"));
  second.origin = {};
  EXPECT_TRUE(check_near(first, second)) << "its place is unknown";
}

class MapCommandTest : public testing::Test {
 protected:
  std::string at(const char* name) const { return (folder_ / name).string(); }
  const test::TemporaryFolder folder_;
};

TEST_F(MapCommandTest, ImportsKeepTheMapThroughAllFormats) {
  ASSERT_TRUE(run(
      {"map", "import", kStreet, at("a.bvm"), "--picture", at("a.png"), "--report", at("a.json")}));
  ASSERT_TRUE(run({"map", "import", at("a.bvm"), at("b.geojson")}));
  ASSERT_TRUE(run({"map", "import", at("b.geojson"), at("c.bvm"), "--bvm-1"}));
  const uint32_t checksum = map_checksum(load_map(kStreet).value());
  for (const char* name : {"a.bvm", "b.geojson", "c.bvm"}) {
    EXPECT_EQ(map_checksum(load_map(at(name)).value()), checksum) << name;
  }
  EXPECT_EQ(read_file(at("a.png"))->substr(1, 3), "PNG");
  EXPECT_THAT(*read_file(at("a.json")), HasSubstr("\"kind\": \"way line_thin"));
  EXPECT_TRUE(run({"map", "diff", kStreet, at("c.bvm"), "--json", at("d.json")}));
  EXPECT_THAT(*read_file(at("d.json")), HasSubstr("\"only_first_m\": 0.0"));
}

TEST_F(MapCommandTest, WritesOverNoFileThatItReads) {
  std::filesystem::copy_file(kStreet, at("street.osm"));
  std::filesystem::create_hard_link(at("street.osm"), at("street.png"));
  ASSERT_TRUE(write_file(at("classes.yaml"), "rules: []\n"));
  const std::vector<std::vector<std::string>> commands{
      {"map", "render", at("street.osm"), at("street.png")},
      {"map", "import", at("street.osm"), at("a.bvm"), "--picture", at("street.png")},
      {"map", "import", at("street.osm"), at("a.bvm"), "--report", at("street.osm")},
      {"map", "import", at("street.osm"), at("a.bvm"), "--classes", at("classes.yaml"), "--report",
       at("classes.yaml")},
      {"map", "info", at("street.osm"), "--json", at("street.osm")},
      {"map", "diff", kStreet, at("street.osm"), "--json", at("street.osm")}};
  for (const auto& words : commands) {
    const Status status = run(words);
    ASSERT_FALSE(status.has_value()) << words[1];
    EXPECT_THAT(status.error().message, HasSubstr("found a file to write that is also read"));
  }
  EXPECT_EQ(*read_file(at("street.osm")), *read_file(kStreet));
  EXPECT_FALSE(std::filesystem::exists(at("a.bvm")));
}

TEST_F(MapCommandTest, WritesOneFileForEachName) {
  EXPECT_THAT(run({"map", "import", kStreet, at("a.bvm"), "--report", at("a.bvm")}).error().message,
              HasSubstr("a.bvm: found one name for two files to write"));
  EXPECT_FALSE(std::filesystem::exists(at("a.bvm")));
}

TEST_F(MapCommandTest, DrawsPngFilesOnly) {
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"map", "render", kStreet, at("q.txt")},
           {"map", "import", kStreet, at("a.bvm"), "--picture", at("q.txt")},
           {"map", "diff", kStreet, kStreet, "--picture", at("q.txt")}}) {
    EXPECT_THAT(run(words).error().message, HasSubstr("wanted .png"));
  }
  EXPECT_FALSE(std::filesystem::exists(at("q.txt")));
}

TEST_F(MapCommandTest, ReplacesMapsByRenaming) {
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"old.bvm"}, {"old.bvm", "--bvm-1"}, {"old.geojson"}}) {
    const std::string out = at(more[0].c_str());
    ASSERT_TRUE(write_file(out, "old"));
    std::filesystem::remove(at("in_use"));
    std::filesystem::create_hard_link(out, at("in_use"));
    std::vector<std::string> words{"map", "import", kStreet, out};
    words.insert(words.end(), more.begin() + 1, more.end());
    ASSERT_TRUE(run(words));
    EXPECT_EQ(*read_file(at("in_use")), "old") << "who has the file open keeps its bytes";
    EXPECT_TRUE(load_map(out).has_value());
  }
}

TEST_F(MapCommandTest, ACheckWritesAllThatWasLeftOut) {
  std::string street = *read_file(kStreet);
  for (int id = 9001; id <= 9007; ++id) {
    street.insert(street.find("</osm>"),
                  fmt::format(R"(<way id="{0}"><nd ref="1"/><nd ref="{0}"/><tag k="type" v="fence"/>
                              </way>)",
                              id));
  }
  ASSERT_TRUE(write_file(at("broken.osm"), street));
  EXPECT_FALSE(run({"map", "check", at("broken.osm"), "--json", at("check.json")}).has_value());
  const auto json = nlohmann::json::parse(*read_file(at("check.json")));
  ASSERT_EQ(json.at("left_out").size(), 7U);
  EXPECT_THAT(json.at("left_out").back().get<std::string>(), HasSubstr("way 9007: found"));
  EXPECT_THAT(json.at("faults").get<std::vector<std::string>>(),
              Contains("left out: 2 more parts"));
}

TEST_F(MapCommandTest, AnOriginIsAPlace) {
  ASSERT_TRUE(write_file(at("local.osm"), R"(<osm>
 <node id="1"><tag k="local_x" v="0"/><tag k="local_y" v="0"/></node>
 <node id="2"><tag k="local_x" v="80"/><tag k="local_y" v="0"/></node>
 <way id="11"><nd ref="1"/><nd ref="2"/><tag k="type" v="curbstone"/></way></osm>)"));
  const auto with = [&](const std::string& origin) {
    return run({"map", "import", at("local.osm"), at("local.bvm"), "--origin", origin});
  };
  EXPECT_THAT(with("0,0").error().message, HasSubstr("(0, 0) stands for an unknown one"));
  for (const char* bad : {"49", "49,", ",8.4", "49,8.4,1", "91,0", "49,+-8"}) {
    EXPECT_FALSE(with(bad).has_value()) << bad;
  }
  ASSERT_TRUE(with(" +49 , 8.4 "));
  EXPECT_EQ(load_map(at("local.bvm"))->origin.latitude_deg, 49.0);
  ASSERT_TRUE(run({"map", "import", at("local.osm"), at("nowhere.bvm")}));
  EXPECT_THAT(
      run({"map", "import", at("nowhere.bvm"), at("b.bvm"), "--origin", "49,8.4"}).error().message,
      HasSubstr("import the original file again with them"));
}

TEST_F(MapCommandTest, SaysWhatIsWrong) {
  EXPECT_THAT(run({"map", "import", kStreet, at("a.json")}).error().message,
              HasSubstr("wanted .bvm or .geojson"));
  EXPECT_THAT(run({"map", "import", kStreet, at("a.png")}).error().message,
              HasSubstr("wanted .bvm or .geojson"));
  EXPECT_THAT(run({"map", "import", kStreet, at("a.geojson"), "--bvm-1"}).error().message,
              HasSubstr("--bvm-1: found " + at("a.geojson") + " as the map to write"));
  EXPECT_FALSE(std::filesystem::exists(at("a.geojson")));
  EXPECT_THAT(run({"map", "import", kStreet, at("a.bvm"), "--origin", "49"}).error().message,
              HasSubstr("--origin: found \"49\", wanted LATITUDE,LONGITUDE"));
  ASSERT_TRUE(write_file(at("text.txt"), "hello").has_value());
  EXPECT_THAT(run({"map", "info", at("text.txt")}).error().message,
              HasSubstr("wanted one of compact (.bvm), Lanelet2 (.osm), OpenDRIVE (.xodr)"));
}

}  // namespace
}  // namespace bevloc::evaluation
