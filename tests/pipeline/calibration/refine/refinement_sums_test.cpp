// Compares the elimination of the framesets with one solution for all unknowns.
#include "pipeline/calibration/refine/refinement_sums.h"

#include <random>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

constexpr Eigen::Index kShared = 11;
constexpr int kFrames = 4;
constexpr Eigen::Index kAll = kShared + kFrames * kFrameUnknowns;

/// All unknowns in one system.
struct WholeSystem {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kAll, kAll);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kAll);

  void add(const RefinementRow& row) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(kAll);
    for (int i = 0; i < row.shared_parts; ++i) {
      const auto& part = row.shared[static_cast<size_t>(i)];
      slope.segment(part.first, part.size) += part.values();
    }
    for (int i = 0; i < row.frame_parts; ++i) {
      const auto& part = row.frames[static_cast<size_t>(i)];
      slope.segment<kFrameUnknowns>(kShared + part.frame * kFrameUnknowns) += part.slope;
    }
    information += row.weight * slope * slope.transpose();
    gradient += row.weight * row.residual * slope;
  }
};

TEST(RefinementSums, EliminatedFramesetsSolveTheWholeSystem) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto noise = [&](double) { return normal(random); };
  RefinementSums sums(kShared, kFrames);
  WholeSystem whole;
  const auto add = [&](const RefinementRow& row) {
    sums.add(row);
    whole.add(row);
  };
  for (int i = 0; i < 200; ++i) {
    RefinementRow row(normal(random), 0.5 + 0.01 * i);
    const int frame = i % kFrames;
    row.add_shared(0, CameraAdjustment::Zero().unaryExpr(noise).eval());
    // The second part lies beside the first, or is the same.
    if (i % 3 == 0) row.add_shared(8, Eigen::Vector2d::Zero().unaryExpr(noise).eval());
    if (i % 3 == 1) row.add_shared(0, CameraAdjustment::Zero().unaryExpr(noise).eval());
    if (i % 3 == 2) row.add_shared(10, Eigen::Matrix<double, 1, 1>(normal(random)));
    row.add_frame(frame, FrameVector::Zero().unaryExpr(noise));
    // The second frameset is the next, the one before, or the same.
    if (i % 5 == 1 && frame + 1 < kFrames) {
      row.add_frame(frame + 1, FrameVector::Zero().unaryExpr(noise));
    }
    if (i % 5 == 2 && frame > 0) row.add_frame(frame - 1, FrameVector::Zero().unaryExpr(noise));
    if (i % 5 == 3) row.add_frame(frame, FrameVector::Zero().unaryExpr(noise));
    add(row);
  }
  const Eigen::VectorXd expected = -whole.information.llt().solve(whole.gradient);
  const EliminatedFrames eliminated(sums);
  const Eigen::VectorXd shared = -eliminated.information().llt().solve(eliminated.gradient());
  EXPECT_TRUE(shared.isApprox(expected.head(kShared), 1e-9));
  const auto frames = eliminated.changes(shared);
  ASSERT_EQ(frames.size(), static_cast<size_t>(kFrames));
  for (int k = 0; k < kFrames; ++k) {
    EXPECT_TRUE(frames[static_cast<size_t>(k)].isApprox(
        expected.segment<kFrameUnknowns>(kShared + k * kFrameUnknowns), 1e-9))
        << k;
  }
}

}  // namespace
}  // namespace bevloc
