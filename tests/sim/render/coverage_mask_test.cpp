#include "sim/render/coverage_mask.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

constexpr int kWidth = 12;
constexpr int kHeight = 9;
using Coverage = std::array<std::array<float, kWidth>, kHeight>;

Coverage coverage_of(const CoverageMask& mask) {
  Coverage coverage{};
  for (int j = 0; j < kHeight; ++j) {
    auto& row = coverage[static_cast<size_t>(j)];
    switch (mask.row(j, row.data())) {
      case CoverageMask::RowKind::kEmpty:
        row.fill(0.0F);
        break;
      case CoverageMask::RowKind::kFull:
        row.fill(1.0F);
        break;
      case CoverageMask::RowKind::kMixed:
        break;
    }
  }
  return coverage;
}

float area_of(const Coverage& coverage) {
  float sum = 0.0F;
  for (const auto& row : coverage) {
    for (const float value : row) sum += value;
  }
  return sum;
}

TEST(CoverageMask, SumsToTheAreaOfATurnedSquare) {
  for (float turn = 0.0F; turn < 1.6F; turn += 0.13F) {
    CoverageMask mask(kWidth, kHeight);
    std::array<Eigen::Vector2f, 4> ring;
    for (size_t i = 0; i < 4; ++i) {
      const float angle = turn + 1.5708F * static_cast<float>(i);
      ring[i] = Eigen::Vector2f(5.3F + 3.0F * std::cos(angle), 4.1F + 3.0F * std::sin(angle));
    }
    mask.add(ring);
    EXPECT_NEAR(area_of(coverage_of(mask)), 18.0F, 1e-3F);
  }
}

TEST(CoverageMask, CoversCellsOnTheEdgePartially) {
  CoverageMask mask(kWidth, kHeight);
  // Cell (i, j) is the unit square around (i, j), so the ring covers half of column 2 and of row 3.
  const std::array<Eigen::Vector2f, 4> ring = {
      {{2.0F, 1.5F}, {5.5F, 1.5F}, {5.5F, 3.0F}, {2.0F, 3.0F}}};
  mask.add(ring);
  const Coverage coverage = coverage_of(mask);
  EXPECT_FLOAT_EQ(coverage[2][2], 0.5F);
  EXPECT_FLOAT_EQ(coverage[2][3], 1.0F);
  EXPECT_FLOAT_EQ(coverage[3][3], 0.5F);
  EXPECT_FLOAT_EQ(coverage[3][2], 0.25F);
  EXPECT_FLOAT_EQ(coverage[2][6], 0.0F);
  EXPECT_FLOAT_EQ(coverage[1][3], 0.0F);
}

TEST(CoverageMask, ClipsAtTheBorders) {
  CoverageMask mask(kWidth, kHeight);
  const std::array<Eigen::Vector2f, 3> ring = {
      {{-100.0F, -50.0F}, {200.0F, 4.0F}, {-100.0F, 60.0F}}};
  mask.add(ring);
  for (const auto& row : coverage_of(mask)) {
    for (const float value : row) EXPECT_NEAR(value, 1.0F, 1e-3F);
  }
}

TEST(CoverageMask, AcceptsBothOrientations) {
  CoverageMask mask(kWidth, kHeight);
  const std::array<Eigen::Vector2f, 3> left = {{{1.0F, 1.0F}, {4.0F, 1.0F}, {1.0F, 5.0F}}};
  const std::array<Eigen::Vector2f, 3> right = {{{6.0F, 1.0F}, {6.0F, 5.0F}, {9.0F, 1.0F}}};
  mask.add(left);
  mask.add(right);
  EXPECT_NEAR(area_of(coverage_of(mask)), 12.0F, 1e-3F);
}

TEST(CoverageMask, OverlapsCountOnce) {
  CoverageMask mask(kWidth, kHeight);
  const std::array<Eigen::Vector2f, 4> ring = {
      {{1.5F, 1.5F}, {5.5F, 1.5F}, {5.5F, 4.5F}, {1.5F, 4.5F}}};
  mask.add(ring);
  mask.add(ring);
  EXPECT_NEAR(area_of(coverage_of(mask)), 12.0F, 1e-3F);
}

TEST(CoverageMask, IsEmptyAfterClear) {
  CoverageMask mask(kWidth, kHeight);
  const std::array<Eigen::Vector2f, 3> ring = {{{1.0F, 1.0F}, {8.0F, 2.0F}, {3.0F, 7.0F}}};
  mask.add(ring);
  mask.clear();
  EXPECT_EQ(area_of(coverage_of(mask)), 0.0F);
}

}  // namespace
}  // namespace bevloc::sim
