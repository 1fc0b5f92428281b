#include "pipeline/map/map_check.h"

#include <limits>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

HdMap map_with(const Eigen::Vector2d& point) {
  HdMap map;
  map.elements.push_back(
      {.element_class = ElementClass::kLaneDivider, .points = {Eigen::Vector2d(0.0, 0.0), point}});
  return map;
}

TEST(MapCheck, RefusesAPointThatIsFarAwayOrNotFinite) {
  EXPECT_TRUE(check_map(map_with({40'000.0, -20'000.0}), "map"));
  for (const double bad : {83'001.0, -83'001.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(check_map(map_with({5.0, bad}), "map")) << bad;
    EXPECT_FALSE(check_map(map_with({bad, 5.0}), "map")) << bad;
  }
}

}  // namespace
}  // namespace bevloc
