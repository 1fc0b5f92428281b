#include "pipeline/map/formats/class_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/formats/map_format.h"
#include "pipeline/map/map_loader.h"

namespace bevloc {
namespace {

using testing::HasSubstr;

std::string table_error(const std::string& text) {
  const auto table = ClassTable::parse(text, "classes.yaml");
  return table ? "" : table.error().message;
}

TEST(ClassTable, TheFirstRuleThatFitsCounts) {
  const auto table = ClassTable::parse(
      "rules:\n  - kind: way wall\n    becomes: nothing\n  - kind: way *\n    becomes: boundary\n",
      "classes.yaml");
  ASSERT_TRUE(table.has_value()) << table.error().message;
  EXPECT_FALSE(table->rule_for("way wall")->becomes.has_value());
  EXPECT_EQ(table->rule_for("way fence")->becomes,
            (Meaning{ElementClass::kRoadBoundary, Appearance::kUnknown}));
  EXPECT_EQ(table->rule_for("lanelet"), nullptr);
}

TEST(ClassTable, RefusesWordsThatMeanNothing) {
  EXPECT_EQ(table_error("rules:\n  - kind: a\n    becomes: pavement\n"),
            "classes.yaml:3: rules[0].becomes: found \"pavement\", wanted divider, crossing, "
            "boundary or nothing");
  EXPECT_THAT(table_error("rules:\n  - kind: a\n    becomes: divider\n    appearance: kerb\n"),
              HasSubstr("classes.yaml:4: rules[0].appearance: found \"kerb\""));
  EXPECT_THAT(table_error("rules:\n  - kind: a\n"), HasSubstr("becomes"));
}

TEST(ClassTable, ChangesLanelet2Maps) {
  const std::string street =
      std::string(BEVLOC_SOURCE_DIR) + "/tests/pipeline/map/fixtures/street.osm";
  const auto plain = import_map(street, {});
  ASSERT_TRUE(plain.has_value()) << plain.error().message;
  const auto rows = plain->report.rows();
  size_t taken = 0;
  for (const ImportRow& row : rows) taken += row.meaning ? row.count : 0;
  EXPECT_EQ(taken, plain->map.elements.size()) << "the report counts every element";
  EXPECT_THAT(text_of(plain->report), HasSubstr("way line_thin"));

  const auto table =
      ClassTable::parse("rules:\n  - kind: way line_thin*\n    becomes: nothing\n", "classes.yaml");
  ImportOptions options;
  options.classes = &*table;
  const auto changed = import_map(street, options);
  ASSERT_TRUE(changed.has_value()) << changed.error().message;
  EXPECT_LT(changed->map.elements.size(), plain->map.elements.size());

  const auto unused =
      ClassTable::parse("rules:\n  - kind: way wal\n    becomes: nothing\n", "classes.yaml");
  options.classes = &*unused;
  EXPECT_THAT(import_map(street, options).error().message,
              HasSubstr("classes.yaml: rules[0]: found a rule for \"way wal\", wanted a kind that "
                        "is in"));

  const auto hidden = ClassTable::parse(
      "rules:\n  - kind: way*\n    becomes: boundary\n  - kind: way line_thin*\n"
      "    becomes: nothing\n",
      "classes.yaml");
  options.classes = &*hidden;
  EXPECT_EQ(import_map(street, options).error().message,
            "classes.yaml: rules[1]: an earlier rule already takes every kind that the rule for "
            "\"way line_thin*\" fits; move the rule for \"way line_thin*\" before it");
}

TEST(ClassTable, MakesNoLineOfARelation) {
  const std::string text = R"(<osm>
    <node id="1" lat="49" lon="8"/><node id="2" lat="49.0005" lon="8"/>
    <node id="3" lat="49.0005" lon="8.0005"/>
    <way id="4"><nd ref="1"/><nd ref="2"/><tag k="type" v="line_thin"/></way>
    <way id="5"><nd ref="2"/><nd ref="3"/></way>
    <relation id="6"><member type="way" ref="5" role="outer"/>
      <tag k="type" v="multipolygon"/><tag k="subtype" v="traffic_island"/></relation></osm>)";
  const auto error_with = [&text](const std::string& rule) {
    const auto table = ClassTable::parse("rules:\n  - " + rule + "\n", "classes.yaml");
    EXPECT_TRUE(table.has_value()) << table.error().message;
    ImportOptions options;
    options.classes = &*table;
    const auto imported = parse_imported(text, "island.osm", options);
    return imported ? "" : imported.error().message;
  };
  const std::string kind = "relation multipolygon traffic_island";
  EXPECT_EQ(error_with("{kind: " + kind + ", becomes: nothing}"), "");
  EXPECT_EQ(error_with("{kind: '*', becomes: boundary}"), "") << "it also fits ways";
  EXPECT_THAT(error_with("{kind: " + kind + ", becomes: crossing}"),
              HasSubstr("classes.yaml: rules[0]: found a rule that makes lines of \"" + kind +
                        "\", which has none in "));
}

TEST(MapFormat, MapsWithoutAnglesTakeThemFromTheirMgrsSquare) {
  const std::string text = R"(<osm>
    <node id="1" lat="" lon=""><tag k="local_x" v="81600"/><tag k="local_y" v="50100"/>
      <tag k="mgrs_code" v="54SUE816501"/><tag k="ele" v="19"/></node>
    <node id="2" lat="" lon=""><tag k="local_x" v="81650"/><tag k="local_y" v="50100"/>
      <tag k="mgrs_code" v="54SUE816501"/><tag k="ele" v="20"/></node>
    <way id="3"><nd ref="1"/><nd ref="2"/><tag k="type" v="line_thin"/></way></osm>)";
  const auto imported = parse_imported(text, "tokyo.osm", {});
  ASSERT_TRUE(imported.has_value()) << imported.error().message;
  EXPECT_NEAR(imported->map.origin.latitude_deg, 35.68, 0.01);
  EXPECT_NEAR(imported->map.origin.longitude_deg, 139.69, 0.01);
  const auto& points = imported->map.elements.at(0).points;
  EXPECT_NEAR((points[1] - points[0]).norm(), 50.0, 0.05);
  EXPECT_EQ(imported->heights_m.at(0), (Heights{19.0, 20.0}));
}

}  // namespace
}  // namespace bevloc
