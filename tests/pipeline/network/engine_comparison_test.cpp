// oneDNN and XNNPACK compute the same: on the models of this folder and on the shipped ones.
//
// Both sum int8 products exactly and round once, to nearest even. They may differ where a real
// number falls on a rounding edge and float32 puts it on either side of it, depending on the order
// of operations; such a step then changes a little what the layers after it see.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "pipeline/network/lowering.h"
#include "pipeline/network/network.h"
#include "pipeline/network/onnx_reader.h"
#include "pipeline/preprocessing/network_camera.h"
#include "sim/sim_rig.h"
#include "tests/pipeline/network/engines.h"
#include "tests/pipeline/network/model_inputs.h"
#include "tests/support/npy.h"

namespace bevloc {
namespace {

constexpr std::array kOutputs{"bev_features", "map_features", "bev_mask"};

/// What the engines may differ by, in steps of the last activation that was rounded.
constexpr double kLargestSteps = 2.0;
constexpr double kMeanSteps = 0.002;
constexpr double kSameSteps = 0.01;  ///< counts as the same value
constexpr double kSameShare = 0.99;

/// In float, of values around 1.
constexpr double kFloatTolerance = 5e-5;

/// The step of the activation that an output was last rounded to; 0 if nothing is rounded.
float last_step(const nn::Program& program, int value) {
  const auto step = std::ranges::find(program.steps, value, nn::output_of);
  if (step == program.steps.end()) return 0.0F;  // an input of the model
  const nn::Value& computed = program.values[static_cast<size_t>(value)];
  if (computed.type != nn::ElementType::kFloat32) return computed.scale;
  return last_step(program, nn::inputs_of(*step).back());
}

/// One network on each engine.
class EngineComparison : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const std::string path = std::string(BEVLOC_SOURCE_DIR "/") + GetParam();
    program_ = nn::lower(nn::read_onnx(path));
    for (const test::NamedEngine& engine : test::engines()) {
      auto network = Network::load(path, {.engine = engine.make});
      ASSERT_TRUE(network) << network.error().message;
      networks_.push_back(std::move(*network));
    }
    ASSERT_EQ(networks_.size(), 2U);
  }

  /// All outputs of one engine.
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
      largest = std::max(largest, difference);
      sum += difference;
      same += difference <= kSameSteps * step ? 1.0 : 0.0;
      squares += static_cast<double>(a[i]) * a[i];
    }
    EXPECT_GT(std::sqrt(squares / count), 0.01) << "hardly any output";
    if (step == 0.0) {
      EXPECT_LE(largest, kFloatTolerance);
      return;
    }
    EXPECT_LE(largest, kLargestSteps * step);
    EXPECT_LE(sum / count, kMeanSteps * step);
    EXPECT_GE(same / count, kSameShare);
  }
};

TEST_P(EngineComparison, OnRandomInput) {
  for (uint32_t seed = 1; seed < 4; ++seed) {
    for (const auto& network : networks_) {
      network->set_view_table(
          test::view_table(kFeatureGrid.cells(), kCameraCount * kImageFeatureCells));
      test::fill_input(network->image_input(), seed);
      test::fill_input(network->raster_input(), seed + 100);
    }
    expect_same_outputs();
  }
}

TEST_P(EngineComparison, OnTheGoldenSamples) {
  const Rig rig = network_rig(sim::nominal_rig());
  const auto cameras = test::read_npy_bytes(test::golden("network/cameras.npy"));
  const auto images = test::read_npy_bytes(test::golden("network/images.npy"));
  const auto rasters = test::read_npy_bytes(test::golden("network/raster.npy"));
  for (size_t i = 0; i < cameras.values.size(); ++i) {
    SCOPED_TRACE("sample " + std::to_string(i));
    for (const auto& network : networks_) {
      network->set_view_table(make_view_table(rig, CameraMask(cameras.values[i]), kFeatureGrid));
      std::ranges::transform(images.entry(i), network->image_input().begin(), [](uint8_t value) {
        return static_cast<int8_t>(static_cast<int>(value) - 128);
      });
      std::ranges::copy(rasters.entry(i), network->raster_input().begin());
    }
    expect_same_outputs();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, EngineComparison,
    ::testing::Values("models/nano.onnx", "models/nano_float.onnx",
                      "tests/pipeline/network/fixtures/tiny_network_int8.onnx",
                      "tests/pipeline/network/fixtures/tiny_network_float.onnx"),
    [](const auto& model) {
      const std::string& path = model.param;
      const size_t begin = path.rfind('/') + 1;
      return path.substr(begin, path.rfind('.') - begin);
    });

}  // namespace
}  // namespace bevloc
