// Parses OpenStreetMap XML files. Keeps the line of every element for error messages.
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

/// Each coordinate is either absent (also if its text is "") or within its range.
struct OsmNode {
  int line = 0;
  std::optional<double> latitude_deg;
  std::optional<double> longitude_deg;
  std::optional<double> local_x_m;  ///< Autoware's tag local_x
  std::optional<double> local_y_m;  ///< Autoware's tag local_y
  std::optional<double> height_m;   ///< tag ele
  std::string mgrs_square;          ///< the 100 km square of Autoware's tag mgrs_code, or ""
};

using OsmTags = std::map<std::string, std::string, std::less<>>;

/// The value of a tag, or "" if the tag is missing.
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

/// Ways and relations in file order, without the elements that JOSM marks as deleted. References
/// may point to missing elements.
struct OsmDocument {
  std::string file;
  std::unordered_map<int64_t, OsmNode> nodes;
  std::vector<OsmWay> ways;
  std::vector<OsmRelation> relations;
};

/// Fails with file and line on text that is not OSM XML, on ids that are repeated or not whole
/// numbers, and on coordinates that are out of range or not numbers.
Result<OsmDocument> parse_osm(std::string_view text, std::string file);

}  // namespace bevloc
