// Compares the counted cost of small models with costs computed by hand.
#include "pipeline/network/model/network_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/model/lowering.h"
#include "pipeline/network/model/onnx_reader.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc {
namespace {

BranchCost cost_of(const std::string& model) {
  return nn::cost_of_branch(nn::lower(nn::read_onnx(test::fixture(model + ".onnx"))), "y");
}

TEST(NetworkCost, Convolution) {
  // A 3 x 3 convolution from int8 [2, 6, 9, 11] to uint8 [2, 20, 9, 11].
  const BranchCost cost = cost_of("conv_int8");
  const uint64_t in = 2 * 6 * 9 * 11;
  const uint64_t out = 2 * 20 * 9 * 11;
  EXPECT_EQ(cost.macs, out * 6 * 9);
  EXPECT_EQ(cost.weight_bytes, 20U * 6 * 9 + 20 * sizeof(float));
  EXPECT_EQ(cost.activation_bytes, in + out);
  EXPECT_EQ(cost.bytes(), cost.weight_bytes + cost.activation_bytes);
}

TEST(NetworkCost, GroupsAndStrides) {
  EXPECT_EQ(cost_of("conv_depthwise_int8").macs, 16U * 8 * 8 * 9);
  EXPECT_EQ(cost_of("conv_strided_int8").macs, 2U * 7 * 5 * 6 * 6 * 9);
}

TEST(NetworkCost, FloatHasTheSameProductsAndLargerWeights) {
  EXPECT_EQ(cost_of("conv_float").macs, cost_of("conv_int8").macs);
  EXPECT_EQ(cost_of("conv_float").weight_bytes, 4U * (20 * 6 * 9 + 20));
}

TEST(NetworkCost, BranchesOfAWholeNetwork) {
  const auto cost = network_cost(test::fixture("tiny_network_int8.onnx"));
  ASSERT_TRUE(cost) << cost.error().message;
  constexpr uint64_t kCells = 100 * 50;
  const auto conv = [](uint64_t pixels, uint64_t in, uint64_t out, uint64_t area) {
    return pixels * in * out * area;
  };
  const uint64_t stride8 = 6 * 12 * 40;
  const uint64_t trunk = conv(6 * 48 * 160, 3, 8, 9) + conv(6 * 24 * 80, 8, 8, 9) +
                         3 * conv(stride8, 8, 8, 9) + conv(6 * 6 * 20, 8, 8, 9) +
                         conv(6 * 6 * 20, 8, 8, 1) + conv(stride8, 8, 8, 1);
  const uint64_t view = kCells * 8 * 8;
  const uint64_t to_solver = conv(kCells, 8, 16, 1) + 2 * conv(kCells, 16, 16, 9);
  EXPECT_EQ(cost->images.macs, trunk + view + 2 * conv(kCells, 8, 8, 9) + to_solver);
  EXPECT_EQ(cost->map.macs, conv(200 * 100, 12, 8, 9) + conv(kCells, 8, 8, 9) + to_solver);
  EXPECT_EQ(cost->mask.macs, conv(kCells, 8, 8, 9) + conv(kCells, 8, 48, 1));
}

TEST(NetworkCost, SaysWhichFileIsMissing) {
  const auto cost = network_cost("none.onnx");
  ASSERT_FALSE(cost);
  EXPECT_THAT(cost.error().message, testing::HasSubstr("none.onnx"));
}

}  // namespace
}  // namespace bevloc
