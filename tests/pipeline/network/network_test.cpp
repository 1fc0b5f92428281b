// The whole network with a tiny model, compared with numpy, and what a run may allocate.
// engine/under_test/ has a file for each form of the engine that these test cases run on.
#include "pipeline/network/network.h"

#include <array>
#include <cmath>
#include <ranges>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "tests/pipeline/network/model_inputs.h"
#include "tests/pipeline/network/network_under_test.h"
#include "tests/support/root_mean_square.h"

namespace bevloc {
namespace {

constexpr int kStride = 61;  // tiny_network_*.expected has every 61st value

std::vector<float> all_outputs(const Network& network, size_t stride = 1) {
  std::vector<float> values;
  for (const auto& output :
       {network.bev_features().data, network.map_features().data, network.mask_logits()}) {
    for (size_t i = 0; i < output.size(); i += stride) values.push_back(output[i]);
  }
  return values;
}

double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<float> difference(a);
  for (size_t i = 0; i < b.size(); ++i) difference[i] -= b[i];
  return test::root_mean_square(difference);
}

TEST(Network, Int8AgreesWithNumpy) {
  const auto network = test::load_network("tiny_network_int8");
  test::run_all(*network);
  const std::vector<float> found = all_outputs(*network, kStride);
  const std::vector<float> expected = test::expected_values("tiny_network_int8");
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_GT(test::root_mean_square(expected), 0.1);
  // The scales are not powers of two. About one sum in 100,000 rounds differently in float32 than
  // in float64. It changes its element by one step and, through the view transform, many outputs a
  // little.
  const auto same = std::ranges::count_if(std::views::iota(size_t{0}, found.size()), [&](size_t i) {
    return std::abs(found[i] - expected[i]) < 1e-5F;
  });
  EXPECT_GT(same, 0.8 * static_cast<double>(found.size()));
  EXPECT_LT(rms_difference(found, expected), 3e-3 * test::root_mean_square(expected));
}

TEST(Network, FloatAgreesWithNumpy) {
  const auto network = test::load_network("tiny_network_float");
  test::run_all(*network);
  EXPECT_THAT(all_outputs(*network, kStride),
              ::testing::Pointwise(::testing::FloatNear(1e-4F),
                                   test::expected_values("tiny_network_float")));
}

TEST(Network, ThreadsDoNotChangeTheResult) {
  const auto one = test::load_network("tiny_network_int8");
  const auto two = test::load_network("tiny_network_int8", 2);
  test::run_all(*one);
  test::run_all(*two);
  EXPECT_EQ(all_outputs(*one), all_outputs(*two));
}

TEST(Network, PartsRunInAnyOrderAndAgain) {
  const auto network = test::load_network("tiny_network_int8");
  test::run_all(*network);
  const std::vector<float> expected = all_outputs(*network);
  network->run_map_branch();
  network->run_mask_head();
  network->run_image_branch();
  network->run_map_branch();
  network->run_mask_head();
  network->run_mask_head();
  EXPECT_EQ(all_outputs(*network), expected);
}

TEST(Network, OutputsStayUntilTheirOwnPartRunsAgain) {
  const auto network = test::load_network("tiny_network_int8");
  test::run_all(*network);
  const std::vector<float> expected = all_outputs(*network);
  network->run_mask_head();
  network->run_map_branch();
  network->run_image_branch();
  EXPECT_EQ(all_outputs(*network), expected);
}

TEST(Network, ReadsTheInputsOfThisRun) {
  const auto network = test::load_network("tiny_network_int8");
  test::run_all(*network);
  const std::vector<float> before = all_outputs(*network);
  test::fill_input(network->image_input(), 3);
  test::run_all(*network);
  const std::vector<float> after = all_outputs(*network);
  const size_t features = network->bev_features().data.size();
  EXPECT_FALSE(std::equal(before.begin(), before.begin() + features, after.begin()));
  EXPECT_TRUE(std::equal(before.begin() + features, before.begin() + 2 * features,
                         after.begin() + features))
      << "the map features changed with the images";
}

TEST(Network, WithoutCamerasTheImagesDoNotMatter) {
  const auto network = test::load_network("tiny_network_int8");
  const size_t entries = static_cast<size_t>(kViewSlots) * kFeatureGrid.cells();
  network->set_view_table({std::vector<int32_t>(entries, 0), std::vector<float>(entries, 0.0F)});
  network->run_image_branch();
  const FeatureView view = network->bev_features();
  const std::vector<float> before(view.data.begin(), view.data.end());
  test::fill_input(network->image_input(), 3);
  network->run_image_branch();
  EXPECT_TRUE(std::ranges::equal(network->bev_features().data, before));
}

TEST(Network, DescribesItsFeaturesAndParameters) {
  const auto network = test::load_network("tiny_network_int8");
  EXPECT_EQ(network->name(), "tiny_network_int8");
  EXPECT_EQ(network->image_input().size(), 6U * 3 * 96 * 320);
  EXPECT_EQ(network->raster_input().size(), 3U * 400 * 200);
  EXPECT_EQ(network->mask_logits().size(), 3U * 400 * 200);
  for (const FeatureView& view : {network->bev_features(), network->map_features()}) {
    EXPECT_EQ(view.channels, 16);
    EXPECT_EQ(view.grid, kFeatureGrid);
    EXPECT_EQ(view.data.size(), 16U * 100 * 50);
  }
  const SolverParameters& parameters = network->solver_parameters();
  EXPECT_FLOAT_EQ(parameters.joint_scale, 150.5F);
  EXPECT_FLOAT_EQ(parameters.x_scale, 90.0F);
  EXPECT_FLOAT_EQ(parameters.y_scale, 120.0F);
  EXPECT_FLOAT_EQ(parameters.yaw_scale, 2000.0F);
  EXPECT_FLOAT_EQ(parameters.gem_omega, 1.25F);
}

TEST(Network, TheScaleOfTheScoreIsOneUnlessTheModelHasAnother) {
  EXPECT_EQ(test::load_network("tiny_network_int8")->solver_parameters().score_scale, 1.0F);
  const auto small =
      Network::load(BEVLOC_SOURCE_DIR "/models/small-lut.onnx", test::network_options());
  ASSERT_TRUE(small) << small.error().message;
  EXPECT_FLOAT_EQ((*small)->solver_parameters().score_scale, 1.11844F);
}

TEST(Network, AllocatesNothingInARun) {
  const auto network = test::load_network("tiny_network_int8");
  const ViewTable table = test::network_view_table();
  test::run_all(*network);
  bench::AllocationCallers callers;
  network->set_view_table(table);
  test::run_all(*network);
  EXPECT_EQ(callers.outside_of("libdnnl"), 0);
}

/// With our own kernels, the shipped model uses no oneDNN primitives, which would allocate.
TEST(Network, TheShippedModelAllocatesNothingAtAll) {
  const auto network = test::load_shipped();
  ASSERT_TRUE(network);
  test::run_all(*network);
  const uint64_t before = bench::allocation_count();
  test::run_all(*network);
  EXPECT_EQ(bench::allocation_count(), before);
}

TEST(Network, DoesOtherWorkOnItsThreadsWithoutAllocating) {
  for (const int threads : {1, 2, 3}) {
    const auto network = test::load_network("tiny_network_int8", threads);
    std::array<int, 7> calls{};
    std::array<std::thread::id, 7> workers;
    const auto body = [&calls, &workers](int index) {
      ++calls[index];
      workers[index] = std::this_thread::get_id();
    };
    network->parallel_for(static_cast<int>(calls.size()), body);
    const uint64_t before = bench::allocation_count();
    network->parallel_for(static_cast<int>(calls.size()), body);
    network->parallel_for(0, body);
    EXPECT_EQ(bench::allocation_count(), before);
    EXPECT_THAT(calls, ::testing::Each(2));
    if (threads > 1) continue;
    EXPECT_THAT(workers, ::testing::Each(std::this_thread::get_id()));
  }
}

TEST(Network, AllocationCounterCounts) {
  bench::AllocationCallers callers;
  const std::vector<int> numbers(1000);
  EXPECT_EQ(numbers.size(), 1000U);
  EXPECT_GE(callers.outside_of("libdnnl"), 1);
}

}  // namespace
}  // namespace bevloc
