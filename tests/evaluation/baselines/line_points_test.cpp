// Centre lines, and the distance to them.
#include "evaluation/baselines/line_points.h"

#include <cmath>

#include <gtest/gtest.h>

#include "evaluation/baselines/distance_field.h"
#include "evaluation/baselines/nearest_line.h"
#include "pipeline/map/map_index.h"
#include "pipeline/map/rasterizer.h"

namespace bevloc::evaluation {
namespace {

constexpr size_t kDivider = static_cast<size_t>(ElementClass::kLaneDivider);
constexpr size_t kBoundary = static_cast<size_t>(ElementClass::kRoadBoundary);

/// A straight divider through (0, 2.03) at 10 degrees.
class StraightLine : public testing::Test {
 protected:
  StraightLine() {
    HdMap map;
    map.elements.push_back({.element_class = ElementClass::kLaneDivider,
                            .appearance = Appearance::kSolid,
                            .points = {at(-100.0), at(100.0)}});
    const MapIndex index(map);
    std::vector<uint8_t> raster(kRasterSize);
    MapRasterizer(index).draw({}, raster);
    lines_ = lines_of_raster(raster);
  }

  Eigen::Vector2d at(double station_m) const { return through_ + station_m * along_; }
  double distance_of(const Eigen::Vector2d& point) const { return normal_.dot(point - through_); }

  Eigen::Vector2d through_{0.0, 2.03};
  Eigen::Vector2d along_{std::cos(radians(10.0)), std::sin(radians(10.0))};
  Eigen::Vector2d normal_{-along_.y(), along_.x()};
  ClassLines lines_;
};

TEST_F(StraightLine, IsFoundToATenthOfACell) {
  ASSERT_GT(lines_[kDivider].size(), 300U);
  for (const LinePoint& point : lines_[kDivider]) {
    EXPECT_NEAR(distance_of(point.position_m), 0.0, 0.1 * kRasterGrid.cell_m);
    EXPECT_GT(std::abs(point.normal.dot(normal_)), 0.995);
  }
}

TEST_F(StraightLine, BelongsToOneClassOnly) {
  EXPECT_TRUE(lines_[kBoundary].empty());
  EXPECT_EQ(NearestLine(lines_[kBoundary]).to({0.0, 0.0}), nullptr);
  EXPECT_TRUE(DistanceField(lines_[kBoundary]).is_empty());
}

TEST_F(StraightLine, HasTheRightDistanceAndGradient) {
  const DistanceField field(lines_[kDivider]);
  const NearestLine nearest(lines_[kDivider]);
  for (const double offset_m : {-3.0, -0.8, 1.1, 2.0}) {
    const Eigen::Vector2d place = at(3.0) + offset_m * normal_;
    const auto reading = field.at(place);
    EXPECT_NEAR(reading.distance_m, std::abs(offset_m), 0.1);
    EXPECT_NEAR(reading.gradient.dot(normal_), offset_m > 0.0 ? 1.0 : -1.0, 0.1);
    ASSERT_NE(nearest.to(place), nullptr);
    EXPECT_LT((nearest.to(place)->position_m - at(3.0)).norm(), 0.4);
  }
  EXPECT_EQ(nearest.to({31.0, 0.0}), nullptr);
}

TEST_F(StraightLine, LosesPointsThatACorrectionMovesOutside) {
  const HypothesisGrid ranges;
  const LinePoints inside = inside_for_all(lines_[kDivider], ranges);
  EXPECT_GT(inside.size(), 250U);
  EXPECT_LT(inside.size(), lines_[kDivider].size());
  const Se2 farthest{ranges.x_m.range, ranges.y_m.range, ranges.yaw_rad.range};
  for (const LinePoint& point : inside) {
    const Eigen::Vector2d moved = farthest * point.position_m;
    EXPECT_LT(std::abs(moved.x()), kRasterGrid.x_range_m());
    EXPECT_LT(std::abs(moved.y()), kRasterGrid.y_range_m());
  }
}

TEST(LinePoints, AreNotFoundInAConstantMask) {
  for (const float value : {0.0F, 1.0F}) {
    const std::vector<float> mask(kRasterSize, value);
    for (const LinePoints& points : lines_of_mask(mask)) EXPECT_TRUE(points.empty());
  }
}

}  // namespace
}  // namespace bevloc::evaluation
