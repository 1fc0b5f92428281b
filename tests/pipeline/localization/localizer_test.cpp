#include "pipeline/localization/localizer.h"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "sim/sim_rig.h"

namespace bevloc {
namespace {

using Pictures = std::array<RgbImage, kCameraCount>;

Pictures noise(const Rig& rig) {
  std::mt19937 random(1);
  Pictures pictures;
  for (size_t camera = 0; camera < pictures.size(); ++camera) {
    const Intrinsics& lens = rig.cameras[camera].intrinsics;
    pictures[camera] = RgbImage(lens.width_px, lens.height_px);
    std::ranges::generate(pictures[camera].pixels, [&] { return static_cast<uint8_t>(random()); });
  }
  return pictures;
}

struct Seen {
  CameraMask used;
  std::vector<float> mask;
};

Seen look(const Rig& rig, const CameraImages& images, int threads) {
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
  Seen seen;
  seen.used = (*localizer)->localize(images, {}, SearchRange::kTracking, result);
  const std::span<const float> mask = (*localizer)->perceived_mask();
  seen.mask.assign(mask.begin(), mask.end());
  return seen;
}

/// One camera is missing, and the picture of another is not of the calibration's size.
TEST(Localizer, SeesTheSameOnAnyNumberOfThreads) {
  const Rig rig = sim::nominal_rig();
  const Pictures pictures = noise(rig);
  const RgbImage small(64, 48);
  CameraImages images;
  for (size_t camera = 0; camera < pictures.size(); ++camera) {
    images.images[camera] = pictures[camera].view();
    images.present[camera] = camera != 4;
  }
  images.images[1] = small.view();

  const Seen one = look(rig, images, 1);
  EXPECT_EQ(one.used, CameraMask(0b101101));
  EXPECT_GT(std::ranges::max(one.mask) - std::ranges::min(one.mask), 1.0F);
  for (const int threads : {2, 3}) {
    const Seen many = look(rig, images, threads);
    EXPECT_EQ(many.used, one.used) << threads;
    EXPECT_EQ(many.mask, one.mask) << threads;
  }
}

}  // namespace
}  // namespace bevloc
