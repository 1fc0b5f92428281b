// Figures of a map, and what is wrong with it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pipeline/map/formats/map_builder.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

struct MapFacts {
  struct OfClass {
    size_t elements = 0;
    size_t points = 0;
    double length_m = 0.0;
  };
  GeoOrigin origin;
  std::array<OfClass, kElementClasses> classes{};  ///< in the order of ElementClass
  size_t lanes = 0;
  double lanes_m = 0.0;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< corners of bounds_of(), m; zero without one
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  uint32_t checksum = 0;
};

MapFacts facts_of(const HdMap& map);

/// Latitude and longitude with that many decimals, or "unknown".
std::string text_of(const GeoOrigin& origin, int decimals);
std::string text_of(const MapFacts& facts);
nlohmann::json json_of(const MapFacts& facts);

/// The report of an import and the figures of its map.
nlohmann::json json_of(const ImportedMap& imported);

/// The faults of a map, one sentence each: the warnings of map_summary.h, lines that lie on each
/// other, lines shorter than 0.1 m, and lanes that have no line nearby to match.
std::vector<std::string> faults_of(const HdMap& map);

}  // namespace bevloc::evaluation
