#include "pipeline/solver/refinement.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"
#include "tests/pipeline/solver/synthetic_scene.h"

namespace bevloc {
namespace {

constexpr int kChannels = 16;
constexpr HypothesisGrid kHypotheses;
const Se2 kTruth{0.83, -0.46, radians(0.7)};

class RefinementTest : public testing::Test {
 protected:
  RefinementTest() {
    const SyntheticScene scene = SyntheticScene::structured(kChannels, 3);
    auto bev = scene.seen_from(kTruth, kFeatureGrid);
    add_noise(bev, 0.03F, 4);
    bev_.assign(bev);
    map_.assign(scene.seen_from({}, kFeatureGrid));
    EXPECT_TRUE(standardise(bev_) && standardise(map_));
  }

  SolverResult refined(SolverResult result) {
    Refinement refinement(kHypotheses, parameters_);
    refinement.refine({{}, bev_}, {{}, map_}, result);
    return result;
  }

  /// From the middle, with uniform distributions.
  static SolverResult ignorant() {
    SolverResult result;
    set_no_evidence(kHypotheses, result);
    return result;
  }

  SolverParameters parameters_{
      .refine_x_scale = 200.0F, .refine_y_scale = 200.0F, .refine_yaw_scale = 200.0F};
  CellFeatures bev_{kFeatureGrid, kChannels, kHypotheses};
  CellFeatures map_{kFeatureGrid, kChannels, kHypotheses};
};

TEST_F(RefinementTest, FindsTheTruthFromTheMiddle) {
  const SolverResult result = refined(ignorant());
  EXPECT_NEAR(result.correction.x_m, kTruth.x_m, 0.1);
  EXPECT_NEAR(result.correction.y_m, kTruth.y_m, 0.1);
  EXPECT_NEAR(result.correction.yaw_rad, kTruth.yaw_rad, radians(0.1));
}

TEST_F(RefinementTest, DoesNotTrustTheConfidenceItIsGiven) {
  const SolverResult expected = refined(ignorant());
  SolverResult sure_of_the_wrong = ignorant();
  for (auto* distribution : {&sure_of_the_wrong.x_probability, &sure_of_the_wrong.y_probability,
                             &sure_of_the_wrong.yaw_probability}) {
    std::ranges::fill(*distribution, 0.0F);
    distribution->back() = 1.0F;
  }
  const SolverResult result = refined(sure_of_the_wrong);
  EXPECT_NEAR(result.correction.x_m, expected.correction.x_m, 1e-5);
  EXPECT_NEAR(result.correction.y_m, expected.correction.y_m, 1e-5);
  EXPECT_NEAR(result.correction.yaw_rad, expected.correction.yaw_rad, 1e-6);
}

TEST_F(RefinementTest, LeavesDistributions) {
  const SolverResult result = refined(ignorant());
  for (const auto* distribution :
       {&result.x_probability, &result.y_probability, &result.yaw_probability}) {
    EXPECT_NEAR(std::accumulate(distribution->begin(), distribution->end(), 0.0), 1.0, 1e-5);
    EXPECT_GE(*std::ranges::min_element(*distribution), 0.0F);
  }
  EXPECT_NEAR(result.correction.x_m, posterior_mean(result.x_probability, kHypotheses.x_m), 1e-6);
}

}  // namespace
}  // namespace bevloc
