// Compares the shipped models with PyTorch on simulated samples (training/golden.py), from the
// image bytes to the distributions of the solver.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/network.h"
#include "pipeline/solver/solver_factory.h"
#include "tests/pipeline/network/golden_samples.h"
#include "tests/pipeline/solver/golden_scenes.h"
#include "tests/support/npy.h"
#include "tests/support/root_mean_square.h"

namespace bevloc {
namespace {

constexpr size_t kFeatureStride = 7;  // training/golden.py, FEATURE_STRIDE

/// The allowed difference between a model and PyTorch.
struct Tolerance {
  double features;       ///< RMS of the difference divided by the RMS of the features
  double mask;           ///< of the mean and the standard deviation of the logits
  double probabilities;  ///< largest difference of a probability
};

struct GoldenModel {
  std::string name;  ///< prefix of the golden vectors' file names
  std::string file;
  Tolerance tolerance;
};

class GoldenNetwork : public ::testing::TestWithParam<GoldenModel> {
 protected:
  static const GoldenModel& model() { return GetParam(); }

  void SetUp() override {
    auto loaded = Network::load(BEVLOC_SOURCE_DIR "/models/" + model().file, {});
    ASSERT_TRUE(loaded) << loaded.error().message;
    network_ = std::move(*loaded);
  }

  test::NpyArray<float> expected(const std::string& what) const {
    return test::read_npy_floats(test::golden("network/" + model().name + "_" + what + ".npy"));
  }

  /// Runs all branches on sample i.
  void run(size_t i) {
    test::set_golden_input(*network_, i);
    network_->run_image_branch();
    network_->run_map_branch();
    network_->run_mask_head();
  }

  std::vector<float> distributions(SolverKind kind) {
    auto solver = make_solver(kind, kFeatureGrid, kFeatureChannels, HypothesisGrid{},
                              network_->solver_parameters());
    SolverResult result;
    (*solver)->solve(network_->bev_features(), network_->map_features(), result);
    return test::distributions(result);
  }

  std::unique_ptr<Network> network_;
};

/// RMS of the difference to `expected`, divided by the RMS of `expected`. `expected` has every 7th
/// value.
double relative_difference(std::span<const float> found, const std::vector<float>& expected) {
  std::vector<float> difference;
  for (size_t i = 0; i < expected.size(); ++i) {
    difference.push_back(found[i * kFeatureStride] - expected[i]);
  }
  return test::root_mean_square(difference) / test::root_mean_square(expected);
}

/// Mean and standard deviation of the logits of each class.
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

// In int8, a sum on the other side of a rounding boundary changes an element by a whole step, and
// through the later layers many elements a little. The rounding error itself is 5 % of the
// features.
INSTANTIATE_TEST_SUITE_P(
    Models, GoldenNetwork,
    ::testing::Values(GoldenModel{"float", "nano_float.onnx", {1e-3, 1e-3, 1e-3}},
                      GoldenModel{"int8", "nano.onnx", {0.03, 0.02, 0.02}}),
    [](const auto& golden) { return golden.param.name; });

}  // namespace
}  // namespace bevloc
