#include "pipeline/localization/localizer.h"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "sim/sim_rig.h"

namespace bevloc {
namespace {

using Images = std::array<RgbImage, kCameraCount>;

Images noise(const Rig& rig) {
  std::mt19937 random(1);
  Images images;
  for (size_t camera = 0; camera < images.size(); ++camera) {
    const Intrinsics& lens = rig.cameras[camera].intrinsics;
    images[camera] = RgbImage(lens.width_px, lens.height_px);
    std::ranges::generate(images[camera].pixels, [&] { return static_cast<uint8_t>(random()); });
  }
  return images;
}

struct Outcome {
  CameraMask used;
  std::vector<float> mask;
};

Outcome localize(const Rig& rig, const CameraImages& images, int threads) {
  const HdMap map;
  const MapIndex index(map);
  LocalizerOptions options;
  options.network.threads = threads;
  auto localizer =
      Localizer::create(rig, index, std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx", options);
  if (!localizer) {
    ADD_FAILURE() << localizer.error().message;
    return {};
  }
  SolverResult result;
  Outcome outcome;
  outcome.used = (*localizer)->localize(images, {}, SearchRange::kTracking, result);
  const std::span<const float> mask = (*localizer)->perceived_mask();
  outcome.mask.assign(mask.begin(), mask.end());
  return outcome;
}

/// One camera is missing, and the image of another has the wrong size.
TEST(Localizer, GivesTheSameResultOnAnyNumberOfThreads) {
  const Rig rig = sim::nominal_rig();
  const Images noise_images = noise(rig);
  const RgbImage small(64, 48);
  CameraImages images;
  for (size_t camera = 0; camera < noise_images.size(); ++camera) {
    images.images[camera] = noise_images[camera].view();
    images.present[camera] = camera != 4;
  }
  images.images[1] = small.view();

  const Outcome one = localize(rig, images, 1);
  EXPECT_EQ(one.used, CameraMask(0b101101));
  EXPECT_GT(std::ranges::max(one.mask) - std::ranges::min(one.mask), 1.0F);
  for (const int threads : {2, 3}) {
    const Outcome many = localize(rig, images, threads);
    EXPECT_EQ(many.used, one.used) << threads;
    EXPECT_EQ(many.mask, one.mask) << threads;
  }
}

}  // namespace
}  // namespace bevloc
