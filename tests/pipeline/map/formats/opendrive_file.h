// Small OpenDRIVE files for tests, and what the importer makes of them.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "pipeline/map/formats/opendrive/opendrive_reader.h"
#include "tests/pipeline/map/formats/imported_map.h"

namespace bevloc::test {

inline constexpr std::string_view kStraight =
    R"(<geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry>)";

/// A road of 100 m: sidewalk, shoulder (1 m), lane (3.5 m) | lane (3.5 m), nothing.
inline constexpr std::string_view kLanes = R"(<laneSection s="0">
  <left><lane id="1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>
    <roadMark sOffset="0" type="solid"/></lane></left>
  <center><lane id="0" type="none"><roadMark sOffset="0" type="broken"/>
    <roadMark sOffset="40" type="solid"/></lane></center>
  <right>
    <lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>
      <roadMark sOffset="0" type="none"/></lane>
    <lane id="-2" type="shoulder"><width sOffset="0" a="1" b="0.01" c="0" d="0"/></lane>
    <lane id="-3" type="sidewalk"><width sOffset="0" a="2" b="0" c="0" d="0"/></lane>
  </right></laneSection>)";

inline std::string file_with(std::string_view roads, std::string_view header = "") {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<OpenDRIVE>\n<header revMajor=\"1\" "
      "revMinor=\"6\">{}</header>\n{}\n"
      "</OpenDRIVE>\n",
      header, roads);
}

inline std::string road_with(std::string_view geometry, std::string_view lanes,
                             std::string_view objects = "", std::string_view before = "",
                             std::string_view junction = "-1", double length_m = 100.0) {
  return fmt::format(
      "<road id=\"7\" length=\"{}\" junction=\"{}\"><planView>{}</planView>\n"
      "<elevationProfile><elevation s='0' a='5' b='0.02' c='0' d='0'/></elevationProfile>\n"
      "<lanes>{}{}</lanes><objects>{}</objects></road>",
      length_m, junction, geometry, before, lanes, objects);
}

inline Result<ImportedMap> read(const std::string& text, const ImportOptions& options = {}) {
  return parse_opendrive(text, "town.xodr", options);
}

inline std::string road_error(const std::string& text) {
  const auto map = read(text);
  return map ? "" : map.error().message;
}

/// The map of a file that must be readable.
inline ImportedMap good(const std::string& text) {
  auto imported = read(text);
  EXPECT_TRUE(imported.has_value()) << road_error(text);
  return imported ? std::move(*imported) : ImportedMap{};
}

}  // namespace bevloc::test
