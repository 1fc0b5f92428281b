// Adds to a world what real streets have beside the lines of a map.
#pragma once

#include <cstdint>

#include "sim/world/world.h"

namespace bevloc::sim {

/// Shares of lines and lanes that have such a thing. All are independent, and 0 adds nothing.
struct StreetClutter {
  double kerb_line = 0.0;        ///< boundaries with one or two painted lines along them
  double studs = 0.0;            ///< dashed lines with raised dots instead of dashes
  double crossing_edges = 0.0;   ///< crossings with lines along the edges, as of a ladder
  double box = 0.0;              ///< lanes with a hatched or crossed box
  double works = 0.0;            ///< lanes with cones and a barrier board
  double bollards = 0.0;         ///< boundaries with a row of bollards outside
  double railing = 0.0;          ///< boundaries with a fence or guard rail outside
  double shadow = 0.0;           ///< lanes with a hard shadow across the road
  double people_per_100m = 0.0;  ///< number of people at boundaries, some of them on the road

  bool operator==(const StreetClutter&) const = default;
};

/// Multiplies all values by a factor; no share exceeds 1.
StreetClutter scaled(const StreetClutter& clutter, double factor);

/// Adds clutter to the world. The map does not change, because no map contains clutter.
void add_clutter(const StreetClutter& clutter, uint64_t seed, World& world);

}  // namespace bevloc::sim
