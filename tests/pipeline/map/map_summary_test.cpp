#include "pipeline/map/map_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

HdMap good_map() {
  HdMap map;
  map.origin = {49.0, 8.0};
  const std::vector<Eigen::Vector2d> line{{0.0, 0.0}, {1.0, 0.0}};
  map.elements = {{ElementClass::kLaneDivider, Appearance::kDashed, line},
                  {ElementClass::kRoadBoundary, Appearance::kKerb, line},
                  {ElementClass::kRoadBoundary, Appearance::kKerb, line}};
  return map;
}

TEST(MapSummary, CountsByClass) {
  EXPECT_EQ(contents_of(good_map()), "1 dividers, 0 crossings, 2 boundaries, 0 lanes");
}

TEST(MapSummary, AGoodMapHasNoWarnings) {
  EXPECT_THAT(warnings_of(good_map()), IsEmpty());
}

TEST(MapSummary, NamesWhatIsMissing) {
  HdMap map = good_map();
  map.origin = {};
  map.elements.clear();
  EXPECT_THAT(warnings_of(map),
              ElementsAre(HasSubstr("no place on earth"), HasSubstr("no lane divider"),
                          HasSubstr("no road boundary")));
}

TEST(MapSummary, ShowsTheFirstPartsThatWereLeftOut) {
  HdMap map = good_map();
  for (int i = 0; i < 7; ++i) map.left_out.push_back("town.osm:" + std::to_string(i));
  const auto warnings = warnings_of(map);
  ASSERT_EQ(warnings.size(), 6U);
  EXPECT_EQ(warnings.front(), "left out: town.osm:0");
  EXPECT_EQ(warnings.back(), "left out: 2 more parts");
  map.left_out.pop_back();
  EXPECT_EQ(warnings_of(map).back(), "left out: 1 more part");
}

}  // namespace
}  // namespace bevloc
