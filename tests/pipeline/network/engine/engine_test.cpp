// Test cases that the engine must pass in every form: small models, one per combination of
// operators, compared with the results of numpy, and programs that none of these models produces.
// under_test/ has a file for each form: with our own kernels, without, and with a cap.
#include "pipeline/network/engine/engine.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/lowering.h"
#include "pipeline/network/model/onnx_reader.h"
#include "tests/pipeline/network/engine/engine_under_test.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc::nn {
namespace {

constexpr int kViewCells = 21;
constexpr int kViewKeys = 3 * 4 * 5;
constexpr auto kU8 = ElementType::kUint8;
constexpr auto kS8 = ElementType::kInt8;
constexpr auto kF32 = ElementType::kFloat32;

std::unique_ptr<Engine> make_engine(const Program& program, const std::vector<Branch>& branches,
                                    int threads = 1) {
  const test::EngineUnderTest& tested = test::engine_under_test();
  return std::make_unique<Engine>(program, branches, kViewCells,
                                  EngineOptions{threads, tested.isa, tested.own_kernels});
}

void fill_input(Engine& engine, ElementType type, const std::string& name = "x") {
  const std::span<std::byte> input = engine.input(name);
  if (type == kS8) {
    test::fill_input(std::span(reinterpret_cast<int8_t*>(input.data()), input.size()), 1);
  } else {
    test::fill_input(std::span(reinterpret_cast<uint8_t*>(input.data()), input.size()), 1);
  }
}

std::vector<float> copy_of(std::span<const float> values) {
  return {values.begin(), values.end()};
}

std::vector<float> run_model(const std::string& name, int threads = 1, int runs = 1) {
  const Graph graph = read_onnx(test::fixture(name + ".onnx"));
  const auto engine = make_engine(lower(graph), {{"y"}}, threads);
  engine->set_view_table(test::view_table(kViewCells, kViewKeys));
  fill_input(*engine, graph.inputs[0].type);
  for (int i = 0; i < runs; ++i) engine->run(0);
  return copy_of(engine->output("y"));
}

/// Expects many different values, so that a comparison with them can fail.
void expect_lively(const std::vector<float>& values) {
  EXPECT_GT(std::set<float>(values.begin(), values.end()).size(), 10U);
}

class EngineModel : public ::testing::TestWithParam<const char*> {};

TEST_P(EngineModel, Int8IsExact) {
  const std::string name = std::string(GetParam()) + "_int8";
  const std::vector<float> expected = test::expected_values(name);
  expect_lively(expected);
  EXPECT_EQ(run_model(name), expected);
}

TEST_P(EngineModel, FloatAgreesWithin1e4) {
  const std::string name = std::string(GetParam()) + "_float";
  EXPECT_THAT(run_model(name),
              ::testing::Pointwise(::testing::FloatNear(1e-4F), test::expected_values(name)));
}

TEST_P(EngineModel, DoesNotDependOnThreadsNorOnEarlierRuns) {
  const std::string name = std::string(GetParam()) + "_int8";
  EXPECT_EQ(run_model(name, 2, 3), test::expected_values(name));
}

INSTANTIATE_TEST_SUITE_P(Operators, EngineModel,
                         ::testing::Values("add", "concat", "concat_rescaled", "conv",
                                           "conv_depthwise", "conv_strided", "conv_unrounded",
                                           "depth_to_space_crd", "depth_to_space_dcr", "max_pool",
                                           "residual", "residual_kept", "residual_projected",
                                           "residual_unrounded", "space_to_depth",
                                           "upsample_linear", "upsample_nearest",
                                           "view_channels_first", "view_channels_last"),
                         [](const auto& name) { return std::string(name.param); });

TEST(Engine, ReusesMemory) {
  const auto engine = make_engine(lower(read_onnx(test::fixture("residual_int8.onnx"))), {{"y"}});
  EXPECT_LT(engine->arena_bytes(), engine->bytes_without_reuse() * 3 / 4);
}

TEST(Engine, SeesNothingWithoutAViewTable) {
  Program program;
  program.values = {{{3, 4, 4, 5}, kU8, 0.25F}, {{1, 4, 7, 3}, kF32}};
  program.steps = {ViewStep{0, 1}};
  program.inputs = {{"x", 0, {3, 4, 4, 5}}};
  program.outputs = {{"y", 1, {1, 4, 7, 3}}};
  const auto engine = make_engine(program, {{"y"}});
  fill_input(*engine, kU8);
  engine->run(0);
  EXPECT_THAT(engine->output("y"), ::testing::Each(0.0F));
  engine->set_view_table(test::view_table(kViewCells, kViewKeys));
  engine->run(0);
  expect_lively(copy_of(engine->output("y")));
}

// --- programs of one step ------------------------------------------------------------------------

using Dims = std::array<int64_t, 4>;

Shape shape_of(const Dims& dims) {
  return {dims.begin(), dims.end()};
}

/// The real values that fill_input() writes to the input, in [n, c, h, w] order.
std::vector<float> input_values(const Value& value) {
  std::vector<uint8_t> bytes(static_cast<size_t>(element_count(shape_of(value.dims))));
  test::fill_input(std::span(bytes), 1);
  std::vector<float> values;
  for (const uint8_t byte : bytes) {
    values.push_back(value.scale * static_cast<float>(byte - (value.type == kS8 ? 128 : 0)));
  }
  return values;
}

float rounded_to(float real, const Value& value) {
  if (value.type == kF32) return real;
  const float lowest = value.type == kU8 ? 0.0F : -128.0F;
  return value.scale * std::clamp(std::nearbyint(real / value.scale), lowest, lowest + 255.0F);
}

/// Runs a program with this step alone and returns its output.
template <typename AnyStep>
std::vector<float> run_step(const AnyStep& step, const Value& input, const Value& output,
                            int threads = 1) {
  Program program;
  program.values = {input, output};
  program.steps = {step};
  program.inputs = {{"x", 0, shape_of(input.dims)}};
  program.outputs = {{"y", 1, shape_of(output.dims)}};
  const auto engine = make_engine(program, {{"y"}}, threads);
  fill_input(*engine, input.type);
  engine->run(0);
  return copy_of(engine->output("y"));
}

TEST(EngineStep, ReluCutsOffNegativeElements) {
  const Value value{{2, 5, 3, 7}, kS8, 0.5F};
  std::vector<float> expected = input_values(value);
  for (float& x : expected) x = std::max(x, 0.0F);
  EXPECT_EQ(run_step(ReluStep{0, 1}, value, value), expected);
}

TEST(EngineStep, ConvertRoundsToNearestAndSaturates) {
  const Dims dims{2, 5, 3, 7};
  for (const Value& input : {Value{dims, kU8, 0.5F}, Value{dims, kS8, 0.5F}}) {
    for (const Value& output : {Value{dims, kU8, 0.25F}, Value{dims, kS8, 0.25F},
                                Value{dims, kU8, 4.0F}, Value{dims, kS8, 4.0F}, Value{dims}}) {
      std::vector<float> expected = input_values(input);
      for (float& x : expected) x = rounded_to(x, output);
      EXPECT_EQ(run_step(ConvertStep{0, 1}, input, output), expected);
    }
  }
}

TEST(EngineStep, MaxPoolIgnoresPadding) {
  const Value input{{2, 5, 4, 6}, kS8, 0.5F};
  const Value output{{2, 5, 3, 3}, kS8, 0.5F};
  const MaxPoolStep step{
      .input = 0, .output = 1, .kernel = {2, 3}, .strides = {2, 2}, .pads = {1, 1, 1, 0}};
  const std::vector<float> values = input_values(input);
  std::vector<float> expected;
  for (int plane = 0; plane < 2 * 5; ++plane) {
    for (int i = 0; i < 9; ++i) {
      float highest = -1000.0F;
      for (int y = std::max(0, i / 3 * 2 - 1); y <= std::min(3, i / 3 * 2); ++y) {
        for (int x = std::max(0, i % 3 * 2 - 1); x <= std::min(5, i % 3 * 2 + 1); ++x) {
          highest = std::max(highest, values[static_cast<size_t>((plane * 4 + y) * 6 + x)]);
        }
      }
      expected.push_back(highest);
    }
  }
  EXPECT_EQ(run_step(step, input, output), expected);
}

/// The convolution of input_values(), computed by definition. The result is exact, because all
/// scales are powers of two.
std::vector<float> convolved(const ConvStep& step, const Value& input, const Value& output) {
  const std::vector<float> values = input_values(input);
  const std::vector<int64_t> weights = step.weights.integers();
  const Shape& w = step.weights.shape;
  const int64_t outs_per_group = w[0] / step.groups;
  std::vector<float> result;
  for (int64_t i = 0; i < element_count(shape_of(output.dims)); ++i) {
    const int64_t x = i % output.dims[3];
    const int64_t y = i / output.dims[3] % output.dims[2];
    const int64_t out = i / (output.dims[3] * output.dims[2]) % output.dims[1];
    const int64_t image = i / (output.dims[3] * output.dims[2] * output.dims[1]);
    float sum = step.bias.empty() ? 0.0F : step.bias[static_cast<size_t>(out)];
    for (int64_t k = 0; k < w[1] * w[2] * w[3]; ++k) {
      const int64_t channel = out / outs_per_group * w[1] + k / (w[2] * w[3]);
      const int64_t row = y * step.strides[0] - step.pads[0] + k / w[3] % w[2] * step.dilations[0];
      const int64_t col = x * step.strides[1] - step.pads[1] + k % w[3] * step.dilations[1];
      if (row < 0 || row >= input.dims[2] || col < 0 || col >= input.dims[3]) continue;
      const int64_t from =
          ((image * input.dims[1] + channel) * input.dims[2] + row) * input.dims[3] + col;
      const int64_t weight = weights[static_cast<size_t>(out * w[1] * w[2] * w[3] + k)];
      sum += values[static_cast<size_t>(from)] * static_cast<float>(weight) *
             step.weight_scale[static_cast<size_t>(out)];
    }
    if (step.relu) sum = std::max(sum, 0.0F);
    result.push_back(rounded_to(sum, output));
  }
  return result;
}

/// A convolution with pseudo-random 7-bit weights of this shape.
ConvStep make_conv(const Shape& shape) {
  ConvStep step;
  step.input = 0;
  step.output = 1;
  step.weights = {kS8, shape, {}};
  for (int64_t i = 0; i < element_count(shape); ++i) {
    const uint32_t number = test::hashed(static_cast<uint32_t>(i), 5) >> 25;
    step.weights.bytes.push_back(static_cast<std::byte>(static_cast<int8_t>(number - 64)));
  }
  for (int64_t i = 0; i < shape[0]; ++i) {
    step.weight_scale.push_back(i % 2 == 0 ? 0x1p-8F : 0x1p-9F);
    step.bias.push_back(static_cast<float>(i - 3) / 4.0F);
  }
  return step;
}

TEST(EngineStep, ConvolutionRoundsToEitherType) {
  ConvStep step = make_conv({7, 5, 3, 3});
  step.pads = {1, 1, 1, 1};
  const Dims dims{2, 7, 6, 5};
  for (const ElementType from : {kU8, kS8}) {
    const Value input{{2, 5, 6, 5}, from, 0x1p-6F};
    for (const Value& output :
         {Value{dims, kU8, 0x1p-5F}, Value{dims, kS8, 0x1p-5F}, Value{dims}}) {
      for (const bool relu : {false, true}) {
        step.relu = relu;
        EXPECT_EQ(run_step(step, input, output), convolved(step, input, output));
      }
    }
  }
}

TEST(EngineStep, EightBitWeightsAreExactOrRefused) {
  ConvStep step = make_conv({7, 16, 3, 3});
  for (std::byte& weight : step.weights.bytes) {
    weight = static_cast<std::byte>(static_cast<int8_t>(weight) > 0 ? 127 : -127);
  }
  const Value input{{1, 16, 6, 5}, kU8, 0x1p-6F};
  const Value output{{1, 7, 4, 3}};
  try {
    EXPECT_EQ(run_step(step, input, output), convolved(step, input, output));
  } catch (const LoadError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("which has no VNNI"));
  }
}

TEST(EngineStep, ConvolutionInGroupsWithHolesAndUnevenPads) {
  ConvStep step = make_conv({8, 3, 3, 2});
  step.groups = 2;
  step.strides = {1, 2};
  step.dilations = {2, 3};
  step.pads = {2, 1, 0, 3};
  step.bias.clear();
  const Value input{{1, 6, 8, 9}, kU8, 0x1p-6F};
  for (const Value& output : {Value{{1, 8, 6, 5}, kS8, 0x1p-4F}, Value{{1, 8, 6, 5}, kF32}}) {
    EXPECT_EQ(run_step(step, input, output), convolved(step, input, output));
  }
}

// --- branches ------------------------------------------------------------------------------------

/// Branch "a" reads the input x directly. Branch "c" reads x and what branch "b" computes.
Program branched_program() {
  const Dims dims{1, 6, 8, 9};
  Program program;
  program.values = {{dims, kU8, 0x1p-6F}, {dims, kU8, 0x1p-5F}, {dims, kS8, 0x1p-5F},
                    {dims, kF32},         {dims, kU8, 0x1p-5F}, {dims, kF32}};
  const auto conv = [](int input, int output, int residual = -1) {
    ConvStep step = make_conv({6, 6, 3, 3});
    step.pads = {1, 1, 1, 1};
    step.input = input;
    step.output = output;
    step.residual = residual;
    return step;
  };
  program.steps = {conv(0, 1), conv(1, 3, 0), conv(0, 2), conv(2, 4, 2), conv(4, 5, 2)};
  program.inputs = {{"x", 0, shape_of(dims)}};
  program.outputs = {{"a", 3, shape_of(dims)}, {"b", 4, shape_of(dims)}, {"c", 5, shape_of(dims)}};
  return program;
}

TEST(EngineBranches, RunInAnyOrderAndAgain) {
  const auto engine = make_engine(branched_program(), {{"a"}, {"b"}, {"c"}});
  fill_input(*engine, kU8);
  const auto all = [&engine] {
    return std::vector{copy_of(engine->output("a")), copy_of(engine->output("b")),
                       copy_of(engine->output("c"))};
  };
  for (const size_t branch : {0, 1, 2}) engine->run(branch);
  const auto expected = all();
  for (const auto& output : expected) expect_lively(output);
  const auto together = make_engine(branched_program(), {{"a", "b", "c"}});
  fill_input(*together, kU8);
  together->run(0);
  EXPECT_EQ(copy_of(together->output("c")), expected[2]);
  for (const std::vector<size_t>& order :
       {std::vector<size_t>{2, 1, 0}, {1, 0, 2}, {1, 2, 0, 2}, {0, 0, 1, 1, 2, 2}}) {
    for (const size_t branch : order) {
      engine->run(branch);
      EXPECT_EQ(all(), expected) << "after branch " << branch;
    }
  }
}

}  // namespace
}  // namespace bevloc::nn
