// The solvers against the definition that training uses (training/solver.py, training/golden.py).
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/support/npy.h"

namespace bevloc {
namespace {

using ::testing::FloatNear;
using ::testing::Pointwise;

constexpr float kProbabilityTolerance = 1e-4F;
constexpr double kPositionTolerance = 1e-4;
constexpr double kYawTolerance = 1e-5;

struct Golden {
  SolverKind kind;
  std::string file;
};

class GoldenSolver : public ::testing::TestWithParam<Golden> {};

std::vector<float> distributions(const SolverResult& result) {
  std::vector<float> all = result.x_probability;
  all.insert(all.end(), result.y_probability.begin(), result.y_probability.end());
  all.insert(all.end(), result.yaw_probability.begin(), result.yaw_probability.end());
  return all;
}

TEST_P(GoldenSolver, AgreesWithTraining) {
  const auto bev = test::read_npy_floats(test::golden("solver/bev.npy"));
  const auto map = test::read_npy_floats(test::golden("solver/map.npy"));
  const auto scales = test::read_npy_floats(test::golden("solver/scales.npy")).values;
  const auto expected = test::read_npy_floats(test::golden("solver/" + GetParam().file + ".npy"));
  const auto estimates =
      test::read_npy_floats(test::golden("solver/" + GetParam().file + "_estimate.npy"));
  const int channels = static_cast<int>(bev.shape.at(1));
  auto solver = make_solver(GetParam().kind, kFeatureGrid, channels, HypothesisGrid{},
                            {.joint_scale = scales.at(0),
                             .x_scale = scales.at(1),
                             .y_scale = scales.at(2),
                             .yaw_scale = scales.at(3)});
  ASSERT_TRUE(solver) << solver.error().message;
  for (size_t i = 0; i < bev.shape.at(0); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    const std::vector<float> bev_data = bev.entry(i);
    const std::vector<float> map_data = map.entry(i);
    SolverResult result;
    (*solver)->solve({bev_data, channels, kFeatureGrid}, {map_data, channels, kFeatureGrid},
                     result);
    ASSERT_EQ(result.evidence, Evidence::kGood);
    EXPECT_THAT(distributions(result),
                Pointwise(FloatNear(kProbabilityTolerance), expected.entry(i)));
    const std::vector<float> estimate = estimates.entry(i);
    EXPECT_NEAR(result.correction.x_m, estimate[0], kPositionTolerance);
    EXPECT_NEAR(result.correction.y_m, estimate[1], kPositionTolerance);
    EXPECT_NEAR(result.correction.yaw_rad, estimate[2], kYawTolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, GoldenSolver,
                         ::testing::Values(Golden{SolverKind::kDecoupledPlain, "decoupled"},
                                           Golden{SolverKind::kBlock, "joint"}),
                         [](const auto& golden) { return golden.param.file; });

}  // namespace
}  // namespace bevloc
