#include "pipeline/map/map_summary.h"

#include <algorithm>

#include <fmt/format.h>

namespace bevloc {
namespace {

/// More sentences about parts that were left out would hide everything else.
constexpr size_t kMostShown = 5;

long count_of(const HdMap& map, ElementClass element_class) {
  return std::ranges::count(map.elements, element_class, &MapElement::element_class);
}

}  // namespace

std::string contents_of(const HdMap& map) {
  return fmt::format("{} dividers, {} crossings, {} boundaries, {} lanes",
                     count_of(map, ElementClass::kLaneDivider),
                     count_of(map, ElementClass::kPedestrianCrossing),
                     count_of(map, ElementClass::kRoadBoundary), map.lanes.size());
}

std::vector<std::string> warnings_of(const HdMap& map) {
  std::vector<std::string> warnings;
  if (!is_known(map.origin)) {
    warnings.push_back(
        "no place on earth: positions from GNSS, and the latitude and longitude on the CAN bus, "
        "mean nothing; import the original file again and say where it is: bevloc map import "
        "--origin LATITUDE,LONGITUDE");
  }
  if (count_of(map, ElementClass::kLaneDivider) == 0) {
    warnings.push_back("no lane divider: the pose across the road rests on boundaries alone");
  }
  if (count_of(map, ElementClass::kRoadBoundary) == 0) {
    warnings.push_back("no road boundary: the pose across the road rests on dividers alone");
  }
  const size_t shown = std::min(map.left_out.size(), kMostShown);
  for (size_t i = 0; i < shown; ++i) warnings.push_back("left out: " + map.left_out[i]);
  if (map.left_out.size() > shown) {
    const size_t more = map.left_out.size() - shown;
    warnings.push_back(fmt::format("left out: {} more part{}", more, more == 1 ? "" : "s"));
  }
  return warnings;
}

}  // namespace bevloc
