// The town's plan: where junctions lie and which of them roads join.
#pragma once

#include <vector>

#include "sim/random.h"
#include "sim/world/path.h"

namespace bevloc::sim {

/// A road's reference line between two junctions.
struct Street {
  size_t from = 0;
  size_t to = 0;
  Polyline line;
};

struct StreetGrid {
  std::vector<Eigen::Vector2d> junctions;  ///< three or more streets meet at each
  std::vector<Street> streets;
};

StreetGrid make_street_grid(Random& random);

}  // namespace bevloc::sim
