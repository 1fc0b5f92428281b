// Makes training samples from the simulator: what a sample shows and how it is varied.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/se2.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/preprocessing/network_camera.h"

namespace bevloc::training {

/// Consecutive samples that share one world, so that the world's making pays.
inline constexpr uint64_t kSamplesPerWorld = 16;

/// Number of bytes of one sample's images: [camera, colour, row, column].
inline constexpr size_t kImagesSize =
    static_cast<size_t>(kCameraCount) * 3 * kNetworkHeightPx * kNetworkWidthPx;

struct Sample {
  std::vector<uint8_t> images;
  CameraMask cameras;
  std::vector<uint8_t> raster_prior;
  std::vector<uint8_t> raster_truth;
  Se2 correction;
};

/// An endless stream of samples; everything about sample i follows from the options and i.
struct Stream {
  uint64_t first_seed = 0;
  double drop_camera_probability = 0.0;
};

/// The rig that the network is told: sample images are taken by cameras close to these.
const Rig& told_network_rig();

/// Makes the samples of one world (world w holds samples w * kSamplesPerWorld and on), from the one
/// numbered `first` within the world, and hands each to `deliver`; stops early when `deliver`
/// returns false.
void make_samples_of_world(const Stream& stream, uint64_t world_number, uint64_t first,
                           const std::function<bool(Sample&&)>& deliver);

}  // namespace bevloc::training
