// The raw content of an OpenStreetMap XML file, with the line of every element.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/result.h"

namespace bevloc {

/// Coordinates are there or not, but never out of range: "" counts as not there.
struct OsmNode {
  int line = 0;
  std::optional<double> latitude_deg;
  std::optional<double> longitude_deg;
  std::optional<double> local_x_m;  ///< Autoware's tag local_x
  std::optional<double> local_y_m;  ///< Autoware's tag local_y
};

using OsmTags = std::map<std::string, std::string, std::less<>>;

/// A tag's value, or "" if there is no such tag.
std::string_view tag_value(const OsmTags& tags, std::string_view key);

struct OsmWay {
  int64_t id = 0;
  int line = 0;
  std::vector<int64_t> nodes;
  OsmTags tags;
};

struct OsmMember {
  std::string type;
  std::string role;
  int64_t ref = 0;
};

struct OsmRelation {
  int64_t id = 0;
  int line = 0;
  std::vector<OsmMember> members;
  OsmTags tags;
};

/// Elements in the file's order; elements that JOSM marks as deleted are left out. References may
/// point to elements that are not there.
struct OsmDocument {
  std::string file;
  std::unordered_map<int64_t, OsmNode> nodes;
  std::vector<OsmWay> ways;
  std::vector<OsmRelation> relations;
};

/// Fails, with file and line, on text that is not OSM XML, on ids that are not whole numbers or are
/// there twice, and on coordinates that are not numbers or out of range.
Result<OsmDocument> parse_osm(std::string_view text, std::string file);

}  // namespace bevloc
