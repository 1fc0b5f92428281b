// How lowering folds the nodes of a graph, and which uses of operators it refuses.
#include "pipeline/network/model/lowering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/onnx_reader.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc::nn {
namespace {

using ::testing::HasSubstr;

template <typename Kind>
long count(const Program& program) {
  return std::ranges::count_if(program.steps,
                               [](const Step& step) { return std::holds_alternative<Kind>(step); });
}

Graph model(const std::string& name) {
  return read_onnx(test::fixture(name + ".onnx"));
}

TEST(Lowering, ResidualBlocksAreConvolutionsAlone) {
  const Program program = lower(model("residual_int8"));
  EXPECT_EQ(count<ConvStep>(program), 5);
  EXPECT_EQ(program.steps.size(), 5U);
}

TEST(Lowering, FeaturePyramidSumIsFoldedThoughTheConvolutionComesFirst) {
  const Program program = lower(model("upsample_nearest_int8"));
  EXPECT_EQ(count<AddStep>(program), 0);
  EXPECT_EQ(count<ConvertStep>(program), 0);
}

TEST(Lowering, WholeNetworkHasNoSeparateArithmetic) {
  const Program program = lower(model("tiny_network_int8"));
  EXPECT_EQ(count<ViewStep>(program), 1);
  EXPECT_EQ(count<RearrangeStep>(program), 2);  // space to depth, depth to space
  EXPECT_EQ(count<AddStep>(program) + count<ReluStep>(program) + count<ConvertStep>(program), 0);
}

TEST(Lowering, FloatGraphStaysFloat) {
  const Program program = lower(model("residual_float"));
  EXPECT_GT(count<ConvStep>(program), 0);
  for (const Step& step : program.steps) {
    if (const auto* conv = std::get_if<ConvStep>(&step)) {
      EXPECT_EQ(conv->weights.type, ElementType::kFloat32);
    }
  }
}

/// The graph of a fixture with one node changed.
class RefusedGraph : public ::testing::Test {
 protected:
  static std::string message_for(const Graph& graph) {
    try {
      lower(graph);
    } catch (const LoadError& error) {
      return error.what();
    }
    return "lowered";
  }

  static Node& node(Graph& graph, Operator op) {
    return *std::ranges::find(graph.nodes, op, &Node::op);
  }
};

TEST_F(RefusedGraph, ZeroPointThatIsNotZero) {
  Graph graph = model("conv_int8");
  graph.constants.at(node(graph, Operator::kQuantizeLinear).inputs[2]).bytes[0] = std::byte{128};
  EXPECT_THAT(message_for(graph), HasSubstr("zero point is 128, wanted 0"));
}

/// Axis 1 is that of the channels only if there are four axes.
TEST_F(RefusedGraph, ConcatOfTensorsWithThreeAxes) {
  Graph graph;
  graph.inputs = {{"x", ElementType::kFloat32, {6, 9, 11}}};
  graph.outputs = {{"y", ElementType::kFloat32, {6, 18, 11}}};
  Node concat{Operator::kConcat, "node 'join' (Concat)", {"x", "x"}, "y", {}};
  concat.attributes["axis"] = int64_t{1};
  graph.nodes.push_back(concat);
  EXPECT_EQ(message_for(graph), "node 'join' (Concat): found an input with 3 axes, wanted 4");
}

TEST_F(RefusedGraph, ScaleThatIsNotPositive) {
  Graph graph = model("conv_int8");
  auto& bytes = graph.constants.at(node(graph, Operator::kQuantizeLinear).inputs[1]).bytes;
  std::ranges::fill(bytes, std::byte{0});
  EXPECT_THAT(message_for(graph), HasSubstr("scale is 0, wanted 1e-15 to 1e+09"));
}

TEST_F(RefusedGraph, DequantizeThatDoesNotUndoQuantize) {
  Graph graph = model("conv_int8");
  for (Node& n : graph.nodes) {
    if (n.op != Operator::kDequantizeLinear || n.output != graph.nodes.back().inputs[0]) continue;
    Tensor scale = graph.constants.at(n.inputs[1]);
    scale.bytes[2] ^= std::byte{0x40};
    graph.constants["other_scale"] = scale;
    n.inputs[1] = "other_scale";
  }
  EXPECT_THAT(message_for(graph), HasSubstr("but the activation was quantized with"));
}

TEST_F(RefusedGraph, WeightsThatDoNotFitTheInput) {
  Graph graph = model("conv_int8");
  node(graph, Operator::kConv).attributes["group"] = int64_t{2};
  EXPECT_THAT(message_for(graph), HasSubstr("in 2 groups do not fit 6 input channels"));
}

TEST_F(RefusedGraph, PaddingByName) {
  Graph graph = model("conv_int8");
  node(graph, Operator::kConv).attributes["auto_pad"] = std::string("SAME_UPPER");
  EXPECT_THAT(message_for(graph), HasSubstr("auto_pad is not supported"));
}

TEST_F(RefusedGraph, ResizeByAnotherFactorOrRule) {
  Graph graph = model("upsample_nearest_int8");
  Graph other_rule = graph;
  node(other_rule, Operator::kResize).attributes["nearest_mode"] = std::string("ceil");
  EXPECT_THAT(message_for(other_rule), HasSubstr("(Resize): mode 'nearest' with coordinates"));
  Tensor& scales = graph.constants.at(node(graph, Operator::kResize).inputs[2]);
  const float three = 3.0F;
  std::memcpy(scales.bytes.data() + 3 * sizeof(float), &three, sizeof(three));
  EXPECT_THAT(message_for(graph), HasSubstr("wanted twice the rows and columns"));
}

TEST_F(RefusedGraph, TransposeThatIsNoPermutation) {
  Graph graph = model("view_channels_last_int8");
  node(graph, Operator::kTranspose).attributes["perm"] = std::vector<int64_t>{0, 0, 1, 2};
  EXPECT_THAT(message_for(graph), HasSubstr("is not a permutation of 4 axes"));
}

TEST_F(RefusedGraph, GatherFromFeaturesInAnotherOrder) {
  Graph graph = model("view_channels_last_int8");
  // Columns before rows, so the keys of the table would select wrong cells.
  node(graph, Operator::kTranspose).attributes["perm"] = std::vector<int64_t>{0, 3, 2, 1};
  EXPECT_THAT(message_for(graph), HasSubstr("are not in the order camera, row, column"));
}

TEST_F(RefusedGraph, SumOverAnythingButTheSlots) {
  Graph graph = model("view_channels_last_int8");
  Tensor& axes = graph.constants.at(node(graph, Operator::kReduceSum).inputs[1]);
  axes.bytes[0] = std::byte{1};
  EXPECT_THAT(message_for(graph), HasSubstr("wanted the 8 slots"));
}

Tensor integers_of(const Shape& values) {
  Tensor tensor{ElementType::kInt64, {static_cast<int64_t>(values.size())}, {}};
  tensor.bytes.resize(values.size() * sizeof(int64_t));
  std::memcpy(tensor.bytes.data(), values.data(), tensor.bytes.size());
  return tensor;
}

TEST_F(RefusedGraph, SumOfEntriesInNeitherOrder) {
  Graph graph = model("view_channels_last_int8");
  graph.constants["other_shape"] = integers_of({21, 8});
  node(graph, Operator::kGather).inputs[1] = "other_index";
  graph.nodes.insert(
      graph.nodes.begin(),
      Node{Operator::kReshape, "reorder", {"view_index", "other_shape"}, "other_index", {}});
  const auto weight =
      std::ranges::find_if(graph.nodes, [](const Node& n) { return n.inputs[0] == "view_weight"; });
  graph.constants.at(weight->inputs[1]) = integers_of({21, 8, 1});
  for (const int64_t axis : {-4, -3, 0, 1}) {
    graph.constants.at(node(graph, Operator::kReduceSum).inputs[1]) = integers_of({axis});
    EXPECT_THAT(message_for(graph), HasSubstr("wanted the 8 slots")) << axis;
  }
}

TEST_F(RefusedGraph, GatherAlongAnAxisThatIsNotThere) {
  for (const int64_t axis : {-3, 2, 7}) {
    Graph graph = model("view_channels_last_int8");
    node(graph, Operator::kGather).attributes["axis"] = axis;
    EXPECT_THAT(message_for(graph), HasSubstr("of the gather, wanted -2 to 1")) << axis;
  }
}

TEST_F(RefusedGraph, ProductOutsideTheViewTransform) {
  Graph graph = model("conv_int8");
  Node& relu = node(graph, Operator::kRelu);
  relu.op = Operator::kMul;
  relu.inputs.push_back(relu.inputs[0]);
  EXPECT_THAT(message_for(graph), HasSubstr("only gathered features times"));
}

TEST_F(RefusedGraph, OutputOfAnotherShapeThanDeclared) {
  Graph graph = model("conv_int8");
  graph.outputs[0].shape = {1, 2, 3, 4};
  EXPECT_THAT(message_for(graph), HasSubstr("output 'y' is declared with shape [1, 2, 3, 4]"));
}

constexpr int64_t kHuge = int64_t{1} << 62;

TEST_F(RefusedGraph, PaddingThatIsNotSmallerThanTheWindow) {
  for (const auto op : {Operator::kConv, Operator::kMaxPool}) {
    for (const int64_t pad : {int64_t{3}, int64_t{1} << 31, kHuge}) {
      Graph graph = model("max_pool_int8");
      node(graph, op).attributes["pads"] = std::vector<int64_t>{1, pad, 1, pad};
      EXPECT_THAT(message_for(graph), HasSubstr("wanted fewer than the 3x3 cells of the window"));
    }
  }
}

/// A 1x1 convolution reads its input in place, so its rows must not reach beyond the image.
TEST_F(RefusedGraph, PaddingOfASinglePixel) {
  Graph graph = model("conv_unrounded_int8");
  node(graph, Operator::kConv).attributes["pads"] = std::vector<int64_t>{0, 0, 1, 0};
  EXPECT_THAT(message_for(graph), HasSubstr("wanted fewer than the 1x1 cells of the window"));
}

TEST_F(RefusedGraph, StrideDilationOrWindowOutOfBounds) {
  for (const int64_t step : {int64_t{65}, int64_t{1} << 32, kHuge}) {
    for (const char* const name : {"strides", "dilations"}) {
      Graph graph = model("conv_int8");
      node(graph, Operator::kConv).attributes[name] = std::vector<int64_t>{1, step};
      EXPECT_THAT(message_for(graph), HasSubstr("wanted two numbers of 1 to 64"));
    }
    Graph graph = model("max_pool_int8");
    node(graph, Operator::kMaxPool).attributes["kernel_shape"] = std::vector<int64_t>{step, 3};
    EXPECT_THAT(message_for(graph), HasSubstr("wanted two numbers of 1 to 64"));
  }
}

/// The square of 2^32 is 0 in 64 bits.
TEST_F(RefusedGraph, BlockSizeOutOfBounds) {
  for (const int64_t block : {int64_t{-1}, int64_t{0}, int64_t{65}, int64_t{1} << 32, kHuge}) {
    Graph to_space = model("depth_to_space_dcr_int8");
    node(to_space, Operator::kDepthToSpace).attributes["blocksize"] = block;
    EXPECT_THAT(message_for(to_space), HasSubstr("wanted 4 axes and a blocksize of 1 to 64"));
    Graph to_depth = model("space_to_depth_int8");
    node(to_depth, Operator::kSpaceToDepth).attributes["blocksize"] = block;
    EXPECT_THAT(message_for(to_depth), HasSubstr("wanted 4 axes and a blocksize of 1 to 64"));
  }
}

/// A graph whose first Reshape reads this shape.
Graph reshaped_to(const Shape& shape) {
  Graph graph = model("view_channels_last_int8");
  for (Node& n : graph.nodes) {
    if (n.op != Operator::kReshape) continue;
    graph.constants["other_shape"] = integers_of(shape);
    n.inputs[1] = "other_shape";
    break;
  }
  return graph;
}

TEST_F(RefusedGraph, ReshapeWhoseSizeOverflows) {
  // In 64 bits, the product of the second is the number of elements.
  EXPECT_THAT(message_for(reshaped_to({kHuge, -1})), HasSubstr("wanted axes of at least 1"));
  EXPECT_THAT(message_for(reshaped_to({kHuge + 300, 4})), HasSubstr("wanted axes of at least 1"));
  EXPECT_THAT(message_for(reshaped_to({-1, -1})), HasSubstr("wanted axes of at least 1"));
  EXPECT_THAT(message_for(reshaped_to(Shape(9, 1))), HasSubstr("9 axes, wanted at most 8"));
}

TEST_F(RefusedGraph, InputBeyondTheBounds) {
  Graph graph = model("conv_int8");
  graph.inputs[0].shape = {1, 6, 4096, 4096};
  EXPECT_THAT(message_for(graph), HasSubstr("at most 16777216 elements"));
  graph.inputs[0].type = ElementType::kInt32;
  EXPECT_THAT(message_for(graph), HasSubstr("input 'x' is int32, wanted float, uint8 or int8"));
}

TEST_F(RefusedGraph, MoreElementsTogetherThanTheBounds) {
  Graph graph = model("conv_int8");
  graph.inputs[0].shape = {1, 16, 1024, 1024};
  for (int i = 0; i < 10; ++i) {
    Node transpose{Operator::kTranspose, "turn", {"x"}, fmt::format("turned_{}", i), {}};
    graph.nodes.insert(graph.nodes.begin(), transpose);
  }
  EXPECT_THAT(message_for(graph), HasSubstr("the model needs more than 134217728 elements"));
}

TEST_F(RefusedGraph, ViewTableWithoutAxes) {
  Graph graph = model("view_channels_last_int8");
  std::ranges::find(graph.inputs, "view_index", &Port::name)->shape = {};
  EXPECT_THAT(message_for(graph), HasSubstr("only a gather by 'view_index' with two axes"));
}

TEST_F(RefusedGraph, ScaleOutOfBounds) {
  for (const float scale : {1e-30F, 1e30F}) {
    Graph graph = model("conv_int8");
    auto& bytes = graph.constants.at(node(graph, Operator::kQuantizeLinear).inputs[1]).bytes;
    std::memcpy(bytes.data(), &scale, sizeof(scale));
    EXPECT_THAT(message_for(graph), HasSubstr("wanted 1e-15 to 1e+09"));
  }
}

TEST_F(RefusedGraph, BiasThatDoesNotFitTheSum) {
  Graph graph = model("conv_int8");
  const std::string bias = node(graph, Operator::kConv).inputs[2];
  const auto dequantized = std::ranges::find(graph.nodes, bias, &Node::output);
  for (std::byte& byte : graph.constants.at(dequantized->inputs[0]).bytes) byte = std::byte{0x7F};
  EXPECT_THAT(message_for(graph), HasSubstr("units of its sum, wanted at most"));
}

TEST_F(RefusedGraph, WindowLargerThanTheImage) {
  Graph graph = model("max_pool_int8");
  node(graph, Operator::kMaxPool).attributes["kernel_shape"] = std::vector<int64_t>{63, 3};
  EXPECT_THAT(message_for(graph), HasSubstr("a window of 63 does not fit"));
}

}  // namespace
}  // namespace bevloc::nn
