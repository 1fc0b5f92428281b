// Adds to a world what real streets have beside the lines of a map.
#pragma once

#include <cstdint>

#include "sim/world/world.h"

namespace bevloc::sim {

/// Shares of lines and lanes that have such a thing. All are independent; 0 adds nothing.
struct StreetClutter {
  double kerb_line = 0.0;        ///< of boundaries: one or two painted lines along them
  double studs = 0.0;            ///< of dashed lines: raised dots instead of dashes
  double crossing_edges = 0.0;   ///< of crossings: lines along the edges, as of a ladder
  double box = 0.0;              ///< of lanes: a hatched or crossed box
  double works = 0.0;            ///< of lanes: cones and a barrier board
  double bollards = 0.0;         ///< of boundaries: a row of bollards outside
  double railing = 0.0;          ///< of boundaries: a fence or guard rail outside
  double shadow = 0.0;           ///< of lanes: a hard shadow across the road
  double people_per_100m = 0.0;  ///< of boundaries: beside the road, and some on it

  bool operator==(const StreetClutter&) const = default;
};

/// Multiplies all values by a factor; no share exceeds 1.
StreetClutter scaled(const StreetClutter& clutter, double factor);

/// The map does not change: nothing of this is in a map.
void add_clutter(const StreetClutter& clutter, uint64_t seed, World& world);

}  // namespace bevloc::sim
