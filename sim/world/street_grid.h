// The street plan of a town: junctions and the streets between them.
#pragma once

#include <vector>

#include "sim/random.h"
#include "sim/world/path.h"

namespace bevloc::sim {

/// A road's reference line between two junctions.
struct Street {
  size_t from = 0;  ///< index of a junction
  size_t to = 0;
  Polyline line;
};

struct StreetGrid {
  std::vector<Eigen::Vector2d> junctions;  ///< places where three or more streets meet
  std::vector<Street> streets;
};

/// Draws a random plan that is connected and has no dead ends.
StreetGrid make_street_grid(Random& random);

}  // namespace bevloc::sim
