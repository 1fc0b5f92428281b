#include "sim/render/cell_index.h"

#include <gtest/gtest.h>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

Box random_box(Random& random, double most_m) {
  const Eigen::Vector2d low(random.uniform(-300.0, 300.0), random.uniform(-100.0, 500.0));
  return {low, low + Eigen::Vector2d(random.uniform(0.0, most_m), random.uniform(0.0, most_m))};
}

TEST(CellIndex, FindsTheSameAsALinearSearch) {
  Random random(3);
  std::vector<Box> boxes;
  for (int i = 0; i < 400; ++i) boxes.push_back(random_box(random, i % 10 == 0 ? 200.0 : 8.0));
  const CellIndex index(boxes);
  for (int i = 0; i < 100; ++i) {
    const Box area = random_box(random, 60.0);
    std::vector<int> expected;
    for (size_t item = 0; item < boxes.size(); ++item) {
      if (boxes[item].intersects(area)) expected.push_back(static_cast<int>(item));
    }
    std::vector<int> found;
    index.query(area, found);
    EXPECT_EQ(found, expected);
  }
}

TEST(CellIndex, FindsNothingOutsideTheItems) {
  std::vector<int> found;
  CellIndex().query({Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)}, found);
  CellIndex({Box(Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1))})
      .query({Eigen::Vector2d(50, 0), Eigen::Vector2d(60, 1)}, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace bevloc::sim
