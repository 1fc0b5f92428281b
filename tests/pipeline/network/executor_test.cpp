// Small models, one for each way in which operators meet, against what numpy computed for them.
// Built twice: with the best instructions of this CPU, and capped to AVX2 without VNNI.
#include "pipeline/network/executor.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/cpu_isa.h"
#include "pipeline/network/lowering.h"
#include "pipeline/network/onnx_reader.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc::nn {
namespace {

constexpr int kViewCells = 21;
constexpr int kViewKeys = 3 * 4 * 5;

std::vector<float> run_model(const std::string& name, int threads = 1, int runs = 1) {
  EXPECT_TRUE(cap_cpu_isa(BEVLOC_TEST_ISA));
  const Graph graph = read_onnx(test::fixture(name + ".onnx"));
  const std::vector<Branch> branches{{"y"}};
  Executor executor(lower(graph), branches, kViewCells, threads);
  executor.set_view_table(test::view_table(kViewCells, kViewKeys));
  const std::span<std::byte> input = executor.input("x");
  if (graph.inputs[0].type == ElementType::kInt8) {
    test::fill_input(std::span(reinterpret_cast<int8_t*>(input.data()), input.size()), 1);
  } else {
    test::fill_input(std::span(reinterpret_cast<uint8_t*>(input.data()), input.size()), 1);
  }
  for (int i = 0; i < runs; ++i) executor.run(0);
  const std::span<const float> output = executor.output("y");
  return {output.begin(), output.end()};
}

/// Enough different values that a test of them can fail.
void expect_lively(const std::vector<float>& values) {
  EXPECT_GT(std::set<float>(values.begin(), values.end()).size(), 10U);
}

class ExecutorModel : public ::testing::TestWithParam<const char*> {};

TEST_P(ExecutorModel, Int8IsExact) {
  const std::string name = std::string(GetParam()) + "_int8";
  const std::vector<float> expected = test::expected_values(name);
  expect_lively(expected);
  EXPECT_EQ(run_model(name), expected);
}

TEST_P(ExecutorModel, FloatAgreesWithin1e4) {
  const std::string name = std::string(GetParam()) + "_float";
  EXPECT_THAT(run_model(name),
              ::testing::Pointwise(::testing::FloatNear(1e-4F), test::expected_values(name)));
}

TEST_P(ExecutorModel, DoesNotDependOnThreadsNorOnEarlierRuns) {
  const std::string name = std::string(GetParam()) + "_int8";
  EXPECT_EQ(run_model(name, 2, 3), test::expected_values(name));
}

INSTANTIATE_TEST_SUITE_P(Operators, ExecutorModel,
                         ::testing::Values("add", "concat", "concat_rescaled", "conv",
                                           "conv_depthwise", "conv_strided", "conv_unrounded",
                                           "depth_to_space_crd", "depth_to_space_dcr", "max_pool",
                                           "residual", "residual_kept", "residual_projected",
                                           "residual_unrounded", "space_to_depth",
                                           "upsample_linear", "upsample_nearest",
                                           "view_channels_first", "view_channels_last"),
                         [](const auto& name) { return std::string(name.param); });

TEST(Executor, ReusesMemory) {
  ASSERT_TRUE(cap_cpu_isa(BEVLOC_TEST_ISA));
  const std::vector<Branch> branches{{"y"}};
  const Executor executor(lower(read_onnx(test::fixture("residual_int8.onnx"))), branches, 0, 1);
  EXPECT_LT(executor.arena_bytes(), executor.bytes_without_reuse() * 3 / 4);
}

}  // namespace
}  // namespace bevloc::nn
