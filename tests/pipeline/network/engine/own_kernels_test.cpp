// Checks that our own kernels and those of oneDNN give the same results, on the models of this
// folder and on the shipped models.
//
// Both sum int8 products exactly and round once, to nearest even. They may differ where a real
// number is so close to a rounding boundary that the order of float32 operations decides. Such a
// difference of one step then changes the later layers a little.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "pipeline/network/model/lowering.h"
#include "pipeline/network/model/onnx_reader.h"
#include "pipeline/network/network.h"
#include "tests/pipeline/network/golden_samples.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc {
namespace {

constexpr std::array kOutputs{"bev_features", "map_features", "bev_mask"};

/// The allowed differences, in steps of the last rounded activation.
constexpr double kLargestSteps = 2.0;
constexpr double kMeanSteps = 0.002;
constexpr double kSameSteps = 0.01;  ///< smaller differences count as equal
constexpr double kSameShare = 0.99;

/// The allowed difference of float models, for values around 1.
constexpr double kFloatTolerance = 5e-5;

/// The step of the last rounded activation on the way to a value; 0 if nothing is rounded.
float last_step(const nn::Program& program, int value) {
  const auto step = std::ranges::find(program.steps, value, nn::output_of);
  if (step == program.steps.end()) return 0.0F;  // an input of the model
  const nn::Value& computed = program.values[static_cast<size_t>(value)];
  if (computed.type != nn::ElementType::kFloat32) return computed.scale;
  return last_step(program, nn::inputs_of(*step).back());
}

/// The same network with our own kernels and without.
class OwnKernels : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const std::string path = std::string(BEVLOC_SOURCE_DIR "/") + GetParam();
    program_ = nn::lower(nn::read_onnx(path));
    for (const bool own_kernels : {true, false}) {
      auto network = Network::load(path, {.own_kernels = own_kernels});
      ASSERT_TRUE(network) << network.error().message;
      networks_.push_back(std::move(*network));
    }
  }

  /// Runs all branches and returns all outputs.
  static std::array<std::span<const float>, 3> run(Network& network) {
    network.run_image_branch();
    network.run_map_branch();
    network.run_mask_head();
    return {network.bev_features().data, network.map_features().data, network.mask_logits()};
  }

  void expect_same_outputs() {
    const auto a = run(*networks_[0]);
    const auto b = run(*networks_[1]);
    for (size_t i = 0; i < kOutputs.size(); ++i) {
      SCOPED_TRACE(kOutputs[i]);
      const auto port = std::ranges::find(program_.outputs, kOutputs[i], &nn::ProgramPort::name);
      expect_same(a[i], b[i], last_step(program_, port->value));
    }
  }

  nn::Program program_;
  std::vector<std::unique_ptr<Network>> networks_;

 private:
  static void expect_same(std::span<const float> a, std::span<const float> b, double step) {
    ASSERT_EQ(a.size(), b.size());
    const double count = static_cast<double>(a.size());
    double largest = 0.0;
    double sum = 0.0;
    double same = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < a.size(); ++i) {
      const double difference = std::abs(static_cast<double>(a[i]) - b[i]);
      ASSERT_TRUE(std::isfinite(difference)) << i;
      largest = std::max(largest, difference);
      sum += difference;
      same += difference <= kSameSteps * step ? 1.0 : 0.0;
      squares += static_cast<double>(a[i]) * a[i];
    }
    EXPECT_GT(std::sqrt(squares / count), 0.01) << "the output is almost zero";
    if (step == 0.0) {
      EXPECT_LE(largest, kFloatTolerance);
      return;
    }
    EXPECT_LE(largest, kLargestSteps * step);
    EXPECT_LE(sum / count, kMeanSteps * step);
    EXPECT_GE(same / count, kSameShare);
  }
};

TEST_P(OwnKernels, OnRandomInput) {
  for (uint32_t seed = 1; seed < 4; ++seed) {
    for (const auto& network : networks_) {
      network->set_view_table(test::network_view_table());
      test::fill_input(network->image_input(), seed);
      test::fill_input(network->raster_input(), seed + 100);
    }
    expect_same_outputs();
  }
}

TEST_P(OwnKernels, OnTheGoldenSamples) {
  for (size_t i = 0; i < test::golden_sample_count(); ++i) {
    SCOPED_TRACE("sample " + std::to_string(i));
    for (const auto& network : networks_) test::set_golden_input(*network, i);
    expect_same_outputs();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, OwnKernels,
    ::testing::Values("models/nano.onnx", "models/nano_float.onnx", "models/small-lut.onnx",
                      "tests/pipeline/network/fixtures/tiny_network_int8.onnx",
                      "tests/pipeline/network/fixtures/tiny_network_float.onnx"),
    [](const auto& model) {
      const std::string& path = model.param;
      const size_t begin = path.rfind('/') + 1;
      std::string name = path.substr(begin, path.rfind('.') - begin);
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace bevloc
