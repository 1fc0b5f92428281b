// The shipped models against PyTorch on the simulator's samples (training/golden.py): the whole way
// from image bytes to distributions over the pose.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/network.h"
#include "pipeline/preprocessing/network_camera.h"
#include "pipeline/solver/solver_factory.h"
#include "sim/sim_rig.h"
#include "tests/pipeline/network/engines.h"
#include "tests/support/npy.h"

namespace bevloc {
namespace {

constexpr size_t kFeatureStride = 7;  // training/golden.py, FEATURE_STRIDE

/// How far a model may be from PyTorch's computation of the same.
struct Tolerance {
  double features;       ///< RMS of the difference over RMS of the features
  double mask;           ///< of mean and deviation of the logits
  double probabilities;  ///< largest difference
};

struct GoldenModel {
  std::string name;  ///< of the golden vectors
  std::string file;
  Tolerance tolerance;
};

using ModelOnEngine = std::tuple<GoldenModel, test::NamedEngine>;

class GoldenNetwork : public ::testing::TestWithParam<ModelOnEngine> {
 protected:
  static const GoldenModel& model() { return std::get<GoldenModel>(GetParam()); }

  void SetUp() override {
    auto loaded = Network::load(BEVLOC_SOURCE_DIR "/models/" + model().file,
                                {.engine = std::get<test::NamedEngine>(GetParam()).make});
    ASSERT_TRUE(loaded) << loaded.error().message;
    network_ = std::move(*loaded);
  }

  test::NpyArray<float> expected(const std::string& what) const {
    return test::read_npy_floats(test::golden("network/" + model().name + "_" + what + ".npy"));
  }

  /// Runs all parts on sample i.
  void run(size_t i) {
    const auto cameras = test::read_npy_bytes(test::golden("network/cameras.npy"));
    const Rig rig = network_rig(sim::nominal_rig());
    network_->set_view_table(make_view_table(rig, CameraMask(cameras.values.at(i)), kFeatureGrid));
    const auto images = test::read_npy_bytes(test::golden("network/images.npy")).entry(i);
    ASSERT_EQ(images.size(), network_->image_input().size());
    std::ranges::transform(images, network_->image_input().begin(), [](uint8_t value) {
      return static_cast<int8_t>(static_cast<int>(value) - 128);
    });
    const auto raster = test::read_npy_bytes(test::golden("network/raster.npy")).entry(i);
    ASSERT_EQ(raster.size(), network_->raster_input().size());
    std::ranges::copy(raster, network_->raster_input().begin());
    network_->run_image_branch();
    network_->run_map_branch();
    network_->run_mask_head();
  }

  std::vector<float> distributions(SolverKind kind) {
    auto solver = make_solver(kind, kFeatureGrid, kFeatureChannels, HypothesisGrid{},
                              network_->solver_parameters());
    SolverResult result;
    (*solver)->solve(network_->bev_features(), network_->map_features(), result);
    std::vector<float> all = result.x_probability;
    all.insert(all.end(), result.y_probability.begin(), result.y_probability.end());
    all.insert(all.end(), result.yaw_probability.begin(), result.yaw_probability.end());
    return all;
  }

  std::unique_ptr<Network> network_;
};

double root_mean_square(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value) * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// RMS of the difference to `expected`, over its own RMS.
double relative_difference(std::span<const float> found, const std::vector<float>& expected) {
  std::vector<float> difference;
  for (size_t i = 0; i < expected.size(); ++i) {
    difference.push_back(found[i * kFeatureStride] - expected[i]);
  }
  return root_mean_square(difference) / root_mean_square(expected);
}

/// Mean and standard deviation of each class's logits.
std::vector<float> mean_and_deviation(std::span<const float> logits) {
  std::vector<float> statistics;
  const size_t size = logits.size() / kRasterChannels;
  for (size_t channel = 0; channel < kRasterChannels; ++channel) {
    double sum = 0.0;
    double square_sum = 0.0;
    for (const float value : logits.subspan(channel * size, size)) {
      sum += value;
      square_sum += static_cast<double>(value) * value;
    }
    const double mean = sum / static_cast<double>(size);
    statistics.push_back(static_cast<float>(mean));
    statistics.push_back(
        static_cast<float>(std::sqrt(square_sum / static_cast<double>(size) - mean * mean)));
  }
  return statistics;
}

TEST_P(GoldenNetwork, FeaturesAndMaskAgreeWithTraining) {
  const auto bev = expected("bev");
  const auto map = expected("map");
  const auto mask = expected("mask_mean_std");
  for (size_t i = 0; i < bev.shape.at(0); ++i) {
    SCOPED_TRACE("sample " + std::to_string(i));
    run(i);
    EXPECT_LT(relative_difference(network_->bev_features().data, bev.entry(i)),
              model().tolerance.features);
    EXPECT_LT(relative_difference(network_->map_features().data, map.entry(i)),
              model().tolerance.features);
    EXPECT_THAT(
        mean_and_deviation(network_->mask_logits()),
        ::testing::Pointwise(::testing::FloatNear(static_cast<float>(model().tolerance.mask)),
                             mask.entry(i)));
  }
}

TEST_P(GoldenNetwork, DistributionsAgreeWithTraining) {
  const auto decoupled = expected("decoupled");
  const auto joint = expected("joint");
  const ::testing::Matcher<std::tuple<float, float>> near =
      ::testing::FloatNear(static_cast<float>(model().tolerance.probabilities));
  for (size_t i = 0; i < decoupled.shape.at(0); ++i) {
    SCOPED_TRACE("sample " + std::to_string(i));
    run(i);
    EXPECT_THAT(distributions(SolverKind::kDecoupled),
                ::testing::Pointwise(near, decoupled.entry(i)));
    EXPECT_THAT(distributions(SolverKind::kBlock), ::testing::Pointwise(near, joint.entry(i)));
  }
}

// In int8 a sum that falls on the other side of a rounding edge moves an element by a whole step,
// and through the layers after it many elements a little. Rounding itself is 5 % of the features.
INSTANTIATE_TEST_SUITE_P(
    Models, GoldenNetwork,
    ::testing::Combine(
        ::testing::Values(GoldenModel{"float", "nano_float.onnx", {1e-3, 1e-3, 1e-3}},
                          GoldenModel{"int8", "nano.onnx", {0.03, 0.02, 0.02}}),
        ::testing::ValuesIn(test::engines())),
    [](const auto& golden) {
      return std::get<GoldenModel>(golden.param).name + "_" +
             std::get<test::NamedEngine>(golden.param).name;
    });

}  // namespace
}  // namespace bevloc
