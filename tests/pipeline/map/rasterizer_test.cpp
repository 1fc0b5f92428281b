#include "pipeline/map/rasterizer.h"

#include <numeric>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

struct Raster {
  std::vector<uint8_t> cells = std::vector<uint8_t>(kRasterSize, uint8_t{77});

  int at(ElementClass channel, int row, int col) const {
    return cells[(static_cast<size_t>(channel) * kRasterGrid.rows + row) * kRasterGrid.cols + col];
  }
  long sum(ElementClass channel) const {
    const auto* first = cells.data() + static_cast<size_t>(channel) * kRasterGrid.cells();
    return std::accumulate(first, first + kRasterGrid.cells(), 0L);
  }
};

HdMap map_of(ElementClass element_class, std::vector<Eigen::Vector2d> points) {
  HdMap map;
  map.elements.push_back({element_class, Appearance::kUnknown, std::move(points)});
  return map;
}

Raster draw(const HdMap& map, const Se2& pose = {}) {
  const MapIndex index(map);
  MapRasterizer rasterizer(index);
  Raster raster;
  rasterizer.draw(pose, raster.cells);
  return raster;
}

/// Centre of mass of `count` cells, whose values `value_at` returns.
template <typename ValueAt>
double centre_of_mass(int count, const ValueAt& value_at) {
  double mass = 0.0;
  double moment = 0.0;
  for (int i = 0; i < count; ++i) {
    mass += value_at(i);
    moment += static_cast<double>(i) * value_at(i);
  }
  return moment / mass;
}

double centre_col(const Raster& raster, ElementClass channel, int row) {
  return centre_of_mass(kRasterGrid.cols, [&](int col) { return raster.at(channel, row, col); });
}

double centre_row(const Raster& raster, ElementClass channel, int col) {
  return centre_of_mass(kRasterGrid.rows, [&](int row) { return raster.at(channel, row, col); });
}

constexpr auto kDivider = ElementClass::kLaneDivider;
constexpr auto kCrossing = ElementClass::kPedestrianCrossing;
constexpr auto kBoundary = ElementClass::kRoadBoundary;

TEST(Rasterizer, RowZeroIsTheFrontAndColumnZeroTheLeftEdge) {
  const Raster raster = draw(map_of(kBoundary, {{25, 10}, {29, 14}}));
  const int row = static_cast<int>(std::lround(kRasterGrid.row_of_x(27)));
  const int col = static_cast<int>(std::lround(kRasterGrid.col_of_y(12)));
  EXPECT_LT(row, 25);
  EXPECT_LT(col, 25);
  EXPECT_EQ(raster.at(kBoundary, row, col), 255);
  EXPECT_EQ(raster.at(kBoundary, row, kRasterGrid.cols - 1 - col), 0);
  EXPECT_EQ(raster.at(kBoundary, kRasterGrid.rows - 1 - row, col), 0);
  EXPECT_EQ(raster.sum(kDivider), 0);
  EXPECT_EQ(raster.sum(kCrossing), 0);
}

TEST(Rasterizer, ALineIsFiveCellsWide) {
  // The line is on a cell centre: two full cells on either side and nothing beyond.
  const double y = kRasterGrid.y_of_col(100);
  const Raster raster = draw(map_of(kDivider, {{-40, y}, {40, y}}));
  for (const int row : {0, 57, 200, 399}) {
    for (int col = 0; col < kRasterGrid.cols; ++col) {
      EXPECT_EQ(raster.at(kDivider, row, col), std::abs(col - 100) <= 2 ? 255 : 0);
    }
  }
}

TEST(Rasterizer, LongitudinalLinesAreAccurateToATenthOfACell) {
  for (int i = 0; i < 40; ++i) {
    const double y = -3.0 + 0.0171 * i;
    const double slope = 0.011 * i;
    const Raster raster = draw(map_of(kDivider, {{-40, y - 40 * slope}, {40, y + 40 * slope}}));
    for (int row = 185; row < 215; ++row) {
      const double expected = kRasterGrid.col_of_y(y + slope * kRasterGrid.x_of_row(row));
      EXPECT_NEAR(centre_col(raster, kDivider, row), expected, 0.1) << y << " " << slope;
    }
  }
}

TEST(Rasterizer, LateralLinesAreAccurateToATenthOfACell) {
  for (int i = 0; i < 40; ++i) {
    const double x = 7.0 + 0.0171 * i;
    const double slope = -0.013 * i;
    const Raster raster = draw(map_of(kBoundary, {{x - 20 * slope, -20}, {x + 20 * slope, 20}}));
    for (int col = 90; col < 110; ++col) {
      const double expected = kRasterGrid.row_of_x(x + slope * kRasterGrid.y_of_col(col));
      EXPECT_NEAR(centre_row(raster, kBoundary, col), expected, 0.1) << x << " " << slope;
    }
  }
}

TEST(Rasterizer, DrawsInTheFrameOfThePose) {
  // The same line relative to two poses: at the origin, and rotated far away.
  const Se2 pose{81234.5, -46001.25, 2.3};
  const std::vector<Eigen::Vector2d> line = {{-5, 3}, {4, -2}, {11, 6}};
  std::vector<Eigen::Vector2d> moved;
  for (const auto& point : line) moved.push_back(pose * point);
  const Raster at_origin = draw(map_of(kDivider, line));
  const Raster far_away = draw(map_of(kDivider, moved), pose);
  for (size_t i = 0; i < kRasterSize; ++i) {
    ASSERT_NEAR(at_origin.cells[i], far_away.cells[i], 1);
  }
}

TEST(Rasterizer, ACrossingIsItsTwoLongestEdges) {
  const Raster raster = draw(map_of(kCrossing, {{4, -5}, {4, 5}, {8, 5}, {8, -5}}));
  const auto value = [&raster](double x, double y) {
    return raster.at(kCrossing, static_cast<int>(std::lround(kRasterGrid.row_of_x(x))),
                     static_cast<int>(std::lround(kRasterGrid.col_of_y(y))));
  };
  EXPECT_EQ(value(4, 0), 255);
  EXPECT_EQ(value(8, 0), 255);
  EXPECT_EQ(value(6, 5), 0);
  EXPECT_EQ(value(6, -5), 0);
  // Starts the ring at another corner, so that a long edge closes it.
  const Raster turned = draw(map_of(kCrossing, {{4, 5}, {8, 5}, {8, -5}, {4, -5}}));
  EXPECT_EQ(turned.cells, raster.cells);
}

TEST(Rasterizer, PolylinesHaveNoGapsAtTheirJoints) {
  const Raster raster = draw(map_of(kDivider, {{0, -3}, {3, 0}, {0, 3}, {-3, 0}}));
  EXPECT_EQ(raster.at(kDivider, static_cast<int>(std::lround(kRasterGrid.row_of_x(3))),
                      static_cast<int>(std::lround(kRasterGrid.col_of_y(0)))),
            255);
}

TEST(Rasterizer, ClipsVeryLongSegments) {
  const Raster raster = draw(map_of(kBoundary, {{-1e6, 2.0}, {1e6, 2.0}}));
  EXPECT_NEAR(centre_col(raster, kBoundary, 13), kRasterGrid.col_of_y(2.0), 0.1);
  const Raster missed = draw(map_of(kBoundary, {{-1e6, 20.0}, {1e6, 20.0}}));
  EXPECT_EQ(missed.sum(kBoundary), 0);
}

TEST(Rasterizer, DrawsTheVisibleHalfOfALineOutside) {
  const double outside_m = kRasterGrid.y_range_m() + 0.15;
  const Raster raster = draw(map_of(kDivider, {{-5, outside_m}, {5, outside_m}}));
  EXPECT_EQ(raster.at(kDivider, 200, 0), 255);
  EXPECT_EQ(raster.at(kDivider, 200, 3), 0);
}

TEST(Rasterizer, HandlesRepeatedPointsAndEmptyMaps) {
  const Raster dot = draw(map_of(kDivider, {{0, 0}, {0, 0}}));
  EXPECT_GT(dot.sum(kDivider), 0);
  EXPECT_EQ(draw(HdMap{}).sum(kDivider), 0);
}

}  // namespace
}  // namespace bevloc
