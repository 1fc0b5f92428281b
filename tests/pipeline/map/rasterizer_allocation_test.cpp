// Counts allocations: after a warm-up the rasterizer allocates nothing.
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "pipeline/map/rasterizer.h"
#include "sim/random.h"

namespace bevloc {
namespace {

TEST(RasterizerAllocationTest, NoneAfterAWarmUp) {
  sim::Random random(3);
  HdMap map;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d start(random.uniform(-100, 100), random.uniform(-100, 100));
    map.elements.push_back({static_cast<ElementClass>(i % 3),
                            Appearance::kUnknown,
                            {start, start + Eigen::Vector2d(5, 1), start + Eigen::Vector2d(9, 4)}});
  }
  const MapIndex index(map);
  MapRasterizer rasterizer(index);
  std::vector<uint8_t> raster(kRasterSize);
  rasterizer.draw({}, raster);
  const uint64_t before = bench::allocation_count();
  rasterizer.draw({}, raster);
  EXPECT_EQ(bench::allocation_count(), before);
}

}  // namespace
}  // namespace bevloc
