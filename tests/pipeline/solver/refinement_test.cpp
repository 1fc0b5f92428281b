#include "pipeline/solver/refinement.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/solver/posterior.h"
#include "pipeline/solver/standardise.h"
#include "tests/pipeline/solver/synthetic_scene.h"
#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

constexpr int kRefinedChannels = 16;
constexpr HypothesisGrid kDefaultHypotheses;
const Se2 kTruth{0.83, -0.46, radians(0.7)};

class RefinementTest : public testing::Test {
 protected:
  RefinementTest() {
    const SyntheticScene scene = SyntheticScene::structured(kRefinedChannels, 3);
    auto bev = scene.seen_from(kTruth, kFeatureGrid);
    add_noise(bev, 0.03F, 4);
    bev_.assign(bev);
    map_.assign(scene.seen_from({}, kFeatureGrid));
    EXPECT_TRUE(standardise(bev_) && standardise(map_));
  }

  SolverResult refined(SolverResult result) {
    Refinement refinement(map_, kDefaultHypotheses, parameters_);
    refinement.refine({{}, bev_}, {{}, map_}, result);
    return result;
  }

  /// A zero correction and uniform distributions.
  static SolverResult uniform() {
    SolverResult result;
    set_no_evidence(kDefaultHypotheses, result);
    return result;
  }

  SolverParameters parameters_{
      .refine_x_scale = 200.0F, .refine_y_scale = 200.0F, .refine_yaw_scale = 200.0F};
  CellFeatures bev_{kFeatureGrid, kRefinedChannels, kDefaultHypotheses};
  CellFeatures map_{kFeatureGrid, kRefinedChannels, kDefaultHypotheses};
};

TEST_F(RefinementTest, FindsTheTruthFromZero) {
  const SolverResult result = refined(uniform());
  EXPECT_THAT(result.correction, test::PoseNear(kTruth, 0.1, radians(0.1)));
}

TEST_F(RefinementTest, IgnoresTheDistributionsOfTheMatcher) {
  const SolverResult expected = refined(uniform());
  SolverResult wrong = uniform();
  for (auto* distribution : {&wrong.x_probability, &wrong.y_probability, &wrong.yaw_probability}) {
    std::ranges::fill(*distribution, 0.0F);
    distribution->back() = 1.0F;
  }
  const SolverResult result = refined(wrong);
  EXPECT_THAT(result.correction, test::PoseNear(expected.correction, 1e-5, 1e-6));
}

TEST_F(RefinementTest, WritesDistributionsAndTheirMean) {
  const SolverResult result = refined(uniform());
  for (const auto* distribution :
       {&result.x_probability, &result.y_probability, &result.yaw_probability}) {
    EXPECT_NEAR(std::accumulate(distribution->begin(), distribution->end(), 0.0), 1.0, 1e-5);
    EXPECT_GE(*std::ranges::min_element(*distribution), 0.0F);
  }
  EXPECT_NEAR(result.correction.x_m, posterior_mean(result.x_probability, kDefaultHypotheses.x_m),
              1e-6);
}

}  // namespace
}  // namespace bevloc
