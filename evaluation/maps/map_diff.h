// Compares two maps.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/result.h"
#include "evaluation/maps/map_facts.h"

namespace bevloc::evaluation {

/// Lines of one class that are this close are the same.
inline constexpr double kSamePlace_m = 0.3;

struct MapDiff {
  struct OfClass {
    double first_m = 0.0;       ///< lines of the first map
    double second_m = 0.0;      ///< lines of the second map
    double only_first_m = 0.0;  ///< without a line of the other map within kSamePlace_m
    double only_second_m = 0.0;
  };
  /// A piece of a line that only one map has, or that both have.
  struct Piece {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
    enum class In : uint8_t { kBoth, kOnlyFirst, kOnlySecond } in;
  };
  std::array<OfClass, kElementClasses> classes{};
  std::vector<Piece> pieces;  ///< about 1 m long
};

/// Fails if the maps lie so far apart that no map reaches from one to the other. A wrong origin is
/// likely then, and one plane would not show both maps.
Status check_near(const HdMap& first, const HdMap& second);

/// Compares class by class. If both maps have a place on earth, the second one is moved into the
/// frame of the first; otherwise their frames must be the same.
MapDiff compare(const HdMap& first, const HdMap& second);

std::string text_of(const MapDiff& diff);
nlohmann::json json_of(const MapDiff& diff);

}  // namespace bevloc::evaluation
