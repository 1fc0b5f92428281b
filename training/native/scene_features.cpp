#include "training/native/scene_features.h"

#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/bev_grid.h"
#include "sim/perception/mask_features.h"
#include "sim/perception/matching_scene.h"

namespace {

constexpr int kChannels = 16;

}  // namespace

void bevloc_scene_features(int count, float* bev, float* map, double* correction) {
  using namespace bevloc::sim;
  const size_t size = static_cast<size_t>(kChannels) * bevloc::kFeatureGrid.cells();
  SceneSampler sampler(kTuningSeedBase);
  MaskFeatures features(kChannels, bevloc::kFeatureGrid);
  MatchingScene scene;
  for (int i = 0; i < count; ++i, bev += size, map += size) {
    sampler.make(static_cast<uint64_t>(i), CorruptionLevel::kPaper, scene);
    features.compute(std::span<const float>(scene.perceived), {bev, size});
    features.compute(std::span<const uint8_t>(scene.raster_prior), {map, size});
    *correction++ = scene.correction.x_m;
    *correction++ = scene.correction.y_m;
    *correction++ = scene.correction.yaw_rad;
  }
}
