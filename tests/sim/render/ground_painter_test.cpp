#include "sim/render/ground_painter.h"

#include <gtest/gtest.h>

#include "sim/world/world_generator.h"
#include "tests/sim/render/small_world.h"

namespace bevloc::sim {
namespace {

constexpr int kLevel = 0;

std::vector<GroundTexel> tile_of(const World& world, const TileKey& key) {
  std::vector<GroundTexel> texels(kTileArea);
  GroundPainter(world).paint(key, texels.data());
  return texels;
}

double albedo(GroundTexel texel) {
  const double root = static_cast<double>((texel >> 8U) & 255U) / 255.0;
  return root * root;
}

/// Mean green albedo along row j of tile (level, 0, 0), between the x coordinates `from_m` and
/// `to_m`.
double mean_albedo(const std::vector<GroundTexel>& tile, int level, int j, double from_m,
                   double to_m) {
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kTileNodes; ++i) {
    const double x_m = i * texel_size_m(level);
    if (x_m < from_m || x_m > to_m) continue;
    sum += albedo(tile[static_cast<size_t>(j) * kTileNodes + static_cast<size_t>(i)]);
    ++count;
  }
  return sum / count;
}

const Polyline kAlongX = {{-20.0, 3.0}, {20.0, 3.0}};

World plain_with(const PaintLine& line) {
  World world = asphalt_plain();
  world.paint_lines.push_back(line);
  return world;
}

constexpr int kLineRow = 60;  // y = 3 m at level 0

TEST(GroundPainter, DashPhaseShiftsTheDashes) {
  // Dashes of 2 m and gaps of 1 m, shifted by 0.5 m: the first dash runs from x = -20 to -18.5.
  const World world =
      plain_with({.points = kAlongX, .width_m = 0.3, .dash_m = 2.0, .gap_m = 1.0, .phase_m = 0.5});
  const auto tile = tile_of(world, {kLevel, 0, 0});
  // At x = 0 the arc length is 20 m; with the phase, 20.5 modulo 3 is 2.5. The gap ends at x = 0.5.
  EXPECT_LT(mean_albedo(tile, kLevel, kLineRow, 0.05, 0.4), 0.25);
  EXPECT_GT(mean_albedo(tile, kLevel, kLineRow, 0.6, 2.4), 0.6);
  EXPECT_LT(mean_albedo(tile, kLevel, kLineRow, 2.6, 3.4), 0.25);
  EXPECT_GT(mean_albedo(tile, kLevel, kLineRow, 3.6, 5.4), 0.6);
}

TEST(GroundPainter, CoarseLevelsKeepTheAmountOfPaint) {
  const PaintLine style{.points = kAlongX, .width_m = 0.2};
  const auto amount = [&](int level) {
    const World bare = asphalt_plain();
    const auto painted = tile_of(plain_with(style), {level, 0, 0});
    const auto ground = tile_of(bare, {level, 0, 0});
    // Across the line, at x = 3.2 m.
    const int i = static_cast<int>(3.2 / texel_size_m(level));
    double sum = 0.0;
    for (int j = 0; j < kTileNodes; ++j) {
      const auto at = static_cast<size_t>(j) * kTileNodes + static_cast<size_t>(i);
      sum += albedo(painted[at]) - albedo(ground[at]);
    }
    return sum * texel_size_m(level);
  };
  EXPECT_NEAR(amount(0), 0.2 * 0.68, 0.02);
  for (int level = 1; level < kGroundLevels; ++level) {
    EXPECT_NEAR(amount(level), amount(0), 0.25 * amount(0)) << "level " << level;
  }
}

TEST(GroundPainter, ATileDoesNotDependOnEarlierTiles) {
  const World world = generate_world(3);
  GroundPainter painter(world);
  std::vector<GroundTexel> tile(kTileArea);
  for (int64_t i = 0; i < 24; ++i) {
    const TileKey key{static_cast<int>(i % 3), (i * 7) % 11 - 5, (i * 5) % 13 - 6};
    painter.paint(key, tile.data());
    EXPECT_EQ(tile, tile_of(world, key)) << key.level << ": " << key.ix << ", " << key.iy;
  }
}

TEST(GroundPainter, WornPaintShowsLess) {
  double previous = 1.0;
  for (const float wear : {0.0F, 0.4F, 0.7F, 1.0F}) {
    const auto tile =
        tile_of(plain_with({.points = kAlongX, .width_m = 0.3, .wear = wear}), {kLevel, 0, 0});
    const double mean = mean_albedo(tile, kLevel, kLineRow, 0.0, 6.4);
    EXPECT_LT(mean, previous) << "wear " << wear;
    previous = mean;
  }
  EXPECT_LT(previous, 0.2);
}

TEST(GroundPainter, LaterSurfacesCoverEarlierOnes) {
  World world = asphalt_plain();
  world.surfaces.push_back({GroundMaterial::kConcrete, 1.0F, {{0, 0}, {3, 0}, {3, 9}, {0, 9}}});
  const auto tile = tile_of(world, {kLevel, 0, 0});
  EXPECT_GT(mean_albedo(tile, kLevel, 40, 0.2, 2.8), 0.22);
  EXPECT_LT(mean_albedo(tile, kLevel, 40, 3.2, 6.0), 0.18);
}

TEST(GroundPainter, NeighbouringTilesShareTheirSeam) {
  const World world = short_street();
  const auto left = tile_of(world, {kLevel, 2, 0});
  const auto right = tile_of(world, {kLevel, 3, 0});
  for (int j = 0; j < kTileNodes; ++j) {
    const auto row = static_cast<size_t>(j) * kTileNodes;
    EXPECT_NEAR(albedo(left[row + kTileTexels]), albedo(right[row]), 0.02) << "row " << j;
  }
}

TEST(GroundPainter, TilesFarOutsideAreBackground) {
  const World world = short_street();
  const auto tile = tile_of(world, {3, 1 << 20, -(1 << 22)});
  const double mean = mean_albedo(tile, 3, 50, 0.0, 50.0);
  EXPECT_GT(mean, 0.03);
  EXPECT_LT(mean, 0.15);
}

TEST(GroundPainter, AShadeDarkensRoadAndPaintAlike) {
  World world = plain_with({.points = kAlongX, .width_m = 0.3});
  const auto bright = tile_of(world, {kLevel, 0, 0});
  world.shades.push_back({{{2.0, -20.0}, {4.0, -20.0}, {4.0, 20.0}, {2.0, 20.0}}, 0.4F});
  const auto shaded = tile_of(world, {kLevel, 0, 0});
  for (const int row : {kLineRow, kLineRow + 20}) {
    const double before = mean_albedo(bright, kLevel, row, 2.2, 3.8);
    EXPECT_NEAR(mean_albedo(shaded, kLevel, row, 2.2, 3.8) / before, 0.4, 0.02) << row;
    EXPECT_DOUBLE_EQ(mean_albedo(shaded, kLevel, row, 4.2, 6.0),
                     mean_albedo(bright, kLevel, row, 4.2, 6.0));
  }
}

}  // namespace
}  // namespace bevloc::sim
