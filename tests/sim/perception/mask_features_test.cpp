#include "sim/perception/mask_features.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/map/rasterizer.h"
#include "tests/sim/perception/small_maps.h"

namespace bevloc::sim {
namespace {

/// A raster with one line of each class that ends well inside.
std::vector<uint8_t> raster_at(const Se2& pose) {
  HdMap map;
  add_divider(map, along_x(-10.0, 9.0, 1.0));
  add_crossing(map, 3.0);
  add_kerb(map, {{-12.0, -7.0}, {8.0, 5.0}});
  const MapIndex index(map);
  std::vector<uint8_t> raster(kRasterSize);
  MapRasterizer(index).draw(pose, raster);
  return raster;
}

struct Case {
  int channels;
  BevGrid grid;
};

class MaskFeaturesOf : public ::testing::TestWithParam<Case> {
 protected:
  std::vector<float> features_of(const std::vector<uint8_t>& raster) const {
    const auto [channels, grid] = GetParam();
    std::vector<float> features(static_cast<size_t>(channels) * grid.cells(), -1.0F);
    MaskFeatures(channels, grid).compute(std::span<const uint8_t>(raster), features);
    return features;
  }
};

TEST_P(MaskFeaturesOf, AreFiniteNonNegativeAndNotConstant) {
  const std::vector<float> features = features_of(raster_at({}));
  const size_t cells = GetParam().grid.cells();
  for (size_t channel = 0; channel * cells < features.size(); ++channel) {
    const auto begin = features.begin() + static_cast<std::ptrdiff_t>(channel * cells);
    const auto [low, high] = std::minmax_element(begin, begin + static_cast<std::ptrdiff_t>(cells));
    EXPECT_GE(*low, 0.0F) << channel;
    EXPECT_TRUE(std::isfinite(*high)) << channel;
    EXPECT_GT(*high, *low + 0.01F) << channel;
  }
}

// Driving 2.4 m forward shifts every channel backwards by 2.4 m.
TEST_P(MaskFeaturesOf, MoveWithTheMask) {
  const std::vector<float> before = features_of(raster_at({}));
  const std::vector<float> after = features_of(raster_at({2.4, 0.0, 0.0}));
  const auto [channels, grid] = GetParam();
  const int shift = static_cast<int>(std::lround(2.4 / grid.cell_m));
  const int rim = static_cast<int>(std::lround(4.8 / grid.cell_m));  // reach of the widest blur
  for (int channel = 0; channel < channels; ++channel) {
    for (int row = rim; row < grid.rows - rim; ++row) {
      for (int col = rim; col < grid.cols - rim; ++col) {
        const auto at = [&, c = col](int r) {
          return (static_cast<size_t>(channel) * grid.rows + r) * grid.cols + c;
        };
        ASSERT_NEAR(after[at(row + shift)], before[at(row)], 0.02)
            << channel << ' ' << row << ' ' << col;
      }
    }
  }
}

TEST_P(MaskFeaturesOf, AnEmptyMaskGivesZero) {
  const std::vector<float> features = features_of(std::vector<uint8_t>(kRasterSize, 0));
  EXPECT_LT(*std::max_element(features.begin(), features.end()), 1e-6F);
}

INSTANTIATE_TEST_SUITE_P(AllSizes, MaskFeaturesOf,
                         ::testing::Values(Case{3, kFeatureGrid}, Case{4, kFeatureGrid},
                                           Case{16, kFeatureGrid}, Case{64, kFeatureGrid},
                                           Case{3, kRasterGrid}, Case{4, kRasterGrid},
                                           Case{16, kRasterGrid}, Case{64, kRasterGrid}));

TEST(MaskFeatures, AreTheSameForARasterAndItsProbabilities) {
  const std::vector<uint8_t> raster = raster_at({});
  std::vector<float> mask(kRasterSize);
  std::transform(raster.begin(), raster.end(), mask.begin(),
                 [](uint8_t value) { return static_cast<float>(value) / 255.0F; });
  MaskFeatures features(16, kFeatureGrid);
  std::vector<float> of_raster(static_cast<size_t>(16) * kFeatureGrid.cells());
  std::vector<float> of_mask = of_raster;
  features.compute(std::span<const uint8_t>(raster), of_raster);
  features.compute(std::span<const float>(mask), of_mask);
  for (size_t i = 0; i < of_mask.size(); ++i) ASSERT_NEAR(of_raster[i], of_mask[i], 1e-4) << i;
}

TEST(MaskFeatures, PoolTheMaskOverEachCell) {
  std::vector<float> mask(kRasterSize, 0.0F);
  mask[4 * 200 + 8] = 1.0F;  // in feature row 1, column 2
  std::vector<float> features(static_cast<size_t>(4) * kFeatureGrid.cells());
  MaskFeatures(4, kFeatureGrid).compute(std::span<const float>(mask), features);
  EXPECT_FLOAT_EQ(features[1 * 50 + 2], 1.0F / 16.0F);
  EXPECT_FLOAT_EQ(features[3 * 5000 + 1 * 50 + 2], 1.0F / 16.0F);  // the union
  EXPECT_FLOAT_EQ(features[5000 + 1 * 50 + 2], 0.0F);
}

TEST(MaskFeatures, FallWithTheDistanceToALine) {
  std::vector<float> mask(kRasterSize, 0.0F);
  for (int row = 0; row < 400; ++row) mask[static_cast<size_t>(row) * 200 + 100] = 0.8F;
  std::vector<float> features(static_cast<size_t>(16) * kRasterGrid.cells());
  MaskFeatures(16, kRasterGrid).compute(std::span<const float>(mask), features);
  const auto nearness = [&](int col) { return features[4UL * 80000 + 200UL * 200 + col]; };
  EXPECT_FLOAT_EQ(nearness(100), 1.0F);
  EXPECT_NEAR(nearness(110), std::exp(-1.5), 1e-3);
  EXPECT_NEAR(nearness(80), std::exp(-3.0), 1e-3);
}

}  // namespace
}  // namespace bevloc::sim
