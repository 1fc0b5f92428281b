#include "pipeline/solver/cell_lattice.h"

#include <set>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

class CellLatticeTest : public testing::TestWithParam<CellLattice> {};

TEST_P(CellLatticeTest, ConsecutiveRowsCoverEveryColumnOnce) {
  constexpr int kCols = 50;
  const int step = GetParam().step;
  for (const int begin : {0, step, 7}) {
    std::multiset<int> cols;
    for (int row = begin; row < begin + step; ++row) {
      for (int i = 0; i < GetParam().cells(row, kCols); ++i) {
        cols.insert(GetParam().first_col(row) + i * step);
      }
    }
    EXPECT_EQ(cols.size(), static_cast<size_t>(kCols));
    EXPECT_EQ(std::set<int>(cols.begin(), cols.end()).size(), cols.size());
    EXPECT_EQ(*cols.rbegin(), kCols - 1);
  }
}

TEST_P(CellLatticeTest, IsSquare) {
  // A square lattice with one of `step` cells has four nearest neighbours at distance sqrt(step).
  const int step = GetParam().step;
  constexpr int kRow = 20;
  const int col = GetParam().first_col(kRow) + 2 * step;
  int nearest = 0;
  for (int i = -step; i <= step; ++i) {
    for (int j = -step; j <= step; ++j) {
      const int square = i * i + j * j;
      const bool belongs = (col + j - GetParam().first_col(kRow + i)) % step == 0;
      if (square == 0 || !belongs) continue;
      EXPECT_GE(square, step);
      nearest += square == step ? 1 : 0;
    }
  }
  EXPECT_EQ(nearest, 4);
}

INSTANTIATE_TEST_SUITE_P(Lattices, CellLatticeTest,
                         testing::Values(kEveryCell, kEverySecondCell, kEveryTenthCell));

TEST(CellLatticeCountTest, CountsTheCellsOfAnyGrid) {
  const BevGrid grid{7, 5, 0.5};
  EXPECT_EQ(kEveryCell.cells(grid), 35);
  EXPECT_EQ(kEverySecondCell.cells(grid), 4 * 3 + 3 * 2);
  // The rows start at columns 0, 3, 6, 9, 2, 5 and 8; three of them are below 5.
  EXPECT_EQ(kEveryTenthCell.cells(grid), 3);
}

}  // namespace
}  // namespace bevloc
