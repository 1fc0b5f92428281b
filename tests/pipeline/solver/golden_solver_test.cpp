// Compares every solver with the Python definition that training uses (training/solvers).
#include <cctype>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/solver/golden_scenes.h"
#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

using ::testing::FloatNear;
using ::testing::Pointwise;

// Python computes in double, C++ mostly in float.
constexpr float kProbabilityTolerance = 1e-4F;
constexpr double kPositionTolerance_m = 1e-4;
constexpr double kYawTolerance_rad = 1e-5;

/// One group of golden vectors from training/golden_solver.py.
struct Group {
  std::string name;
  std::string features;
  HypothesisGrid hypotheses;

  friend std::ostream& operator<<(std::ostream& out, const Group& group) {
    return out << group.name;
  }
};

HypothesisGrid with_steps(double step_m, double step_rad, double y_range_m) {
  return {{2.0, step_m}, {y_range_m, step_m}, {radians(2.0), step_rad}};
}

const std::vector<Group>& groups() {
  static const std::vector<Group> all{
      {"scenes", "scenes", {}},
      {"masks", "masks", {}},
      {"coarse", "scenes", with_steps(0.4, radians(0.4), 1.2)},
      {"fine", "masks", with_steps(0.1, radians(0.1), 1.0)},
  };
  return all;
}

SolverParameters parameters_for(SolverKind kind) {
  const auto values = test::read_npy_floats(test::golden("solver/parameters.npy")).values;
  return {.joint_scale = values.at(0),
          .x_scale = values.at(1),
          .y_scale = values.at(2),
          .yaw_scale = values.at(3),
          .refine_x_scale = values.at(6),
          .refine_y_scale = values.at(7),
          .refine_yaw_scale = values.at(8),
          .banded_x_scale = values.at(4),
          .banded_y_scale = values.at(5),
          .gem_omega = is_literal(kind) ? values.at(9) : 1.0F};
}

/// Entry [kind, sample] of an array [kind, sample, ...].
std::vector<float> entry(const test::NpyArray<float>& array, size_t kind, size_t sample) {
  const size_t size = array.shape.at(2);
  const auto begin = array.values.begin() + (kind * array.shape.at(1) + sample) * size;
  return {begin, begin + size};
}

class GoldenSolver : public ::testing::TestWithParam<std::tuple<SolverKind, Group>> {};

TEST_P(GoldenSolver, AgreesWithTraining) {
  const auto& [kind, group] = GetParam();
  const auto load = [](const std::string& name) {
    return test::read_npy_floats(test::golden("solver/" + name + ".npy"));
  };
  const auto bev = load(group.features + "_bev");
  const auto map = load(group.features + "_map");
  const auto expected = load(group.name + "_distributions");
  const auto estimates = load(group.name + "_estimates");
  const auto kind_index = static_cast<size_t>(kind);
  ASSERT_EQ(expected.shape.at(0), kSolverKinds);

  const int channels = static_cast<int>(bev.shape.at(1));
  auto solver = make_solver(kind, kFeatureGrid, channels, group.hypotheses, parameters_for(kind));
  ASSERT_TRUE(solver) << solver.error().message;
  for (size_t i = 0; i < bev.shape.at(0); ++i) {
    SCOPED_TRACE("sample " + std::to_string(i));
    const SolverResult result = test::solve_sample(**solver, bev, map, i);
    ASSERT_EQ(result.evidence, Evidence::kGood);
    EXPECT_THAT(test::distributions(result),
                Pointwise(FloatNear(kProbabilityTolerance), entry(expected, kind_index, i)));
    const std::vector<float> estimate = entry(estimates, kind_index, i);
    EXPECT_THAT(result.correction, test::PoseNear({estimate[0], estimate[1], estimate[2]},
                                                  kPositionTolerance_m, kYawTolerance_rad));
  }
}

std::string name_of_case(const ::testing::TestParamInfo<GoldenSolver::ParamType>& info) {
  std::string name = std::get<1>(info.param).name + "_";
  for (char letter : name_of(std::get<0>(info.param))) {
    name += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Kinds, GoldenSolver,
                         ::testing::Combine(::testing::ValuesIn(all_solver_kinds()),
                                            ::testing::ValuesIn(groups())),
                         name_of_case);

}  // namespace
}  // namespace bevloc
