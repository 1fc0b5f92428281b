// Says in words what a map contains and what is wrong with it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/map/hd_map.h"

namespace bevloc {

/// Returns a text such as "12 dividers, 3 crossings, 40 boundaries, 18 lanes".
std::string contents_of(const HdMap& map);

/// What a user of the map should know, one sentence each, most important first: that it lacks an
/// origin, dividers or boundaries, and what its reader left out (the first sentences and the number
/// of the others).
std::vector<std::string> warnings_of(const HdMap& map);

}  // namespace bevloc
