// Makes samples from the simulator for training and evaluation: what the cameras see at a place,
// the map drawn there, and the map drawn at a pose that is a little wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/se2.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/preprocessing/network_camera.h"
#include "sim/samples/nuisances.h"
#include "sim/samples/training_nuisances.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {

/// Consecutive samples that share one world, so that the world's making pays.
inline constexpr uint64_t kSamplesPerWorld = 16;

/// World seeds on which networks are judged: above the small ones of demos, tests and training's
/// own validation, below those of the scenes for solvers (sim/perception/matching_scene.h).
inline constexpr uint64_t kSampleSeedCount = 1ULL << 30U;
inline constexpr uint64_t kEvaluationSampleSeedBase = 1ULL << 30U;
static_assert(kEvaluationSampleSeedBase + kSampleSeedCount <= kFirstTrainingSeed);

/// Number of bytes of one sample's images: [camera, colour, row, column].
inline constexpr size_t kImagesSize =
    static_cast<size_t>(kCameraCount) * 3 * kNetworkHeightPx * kNetworkWidthPx;

struct Sample {
  std::vector<uint8_t> images;
  CameraMask cameras;
  CameraMotions reference_from_exposure{};  ///< against the time of T, as the vehicle knows them
  std::vector<uint8_t> raster_prior;        ///< the localizer's map at T0
  std::vector<uint8_t> raster_truth;        ///< the world's own map at T
  Se2 correction;                           ///< dT = T0^-1 T
};

/// An endless stream of samples; everything about sample i follows from the stream and i. Streams
/// that differ in their nuisances alone show the same places from the same poses.
struct SampleStream {
  uint64_t first_seed = 0;
  Nuisances nuisances;
  /// Every world is this map, which must have lanes, dressed anew; null: worlds are made-up towns.
  const HdMap* map = nullptr;
  /// On top of `nuisances`.
  TrainingNuisances training{};
};

/// The rig that the network is told: sample images are taken by cameras close to these.
const Rig& told_network_rig();

/// Makes the samples of one world (world w holds samples w * kSamplesPerWorld and on), from the one
/// numbered `first` within the world, and hands each to `deliver`; stops early when `deliver`
/// returns false.
void make_samples_of_world(const SampleStream& stream, uint64_t world_number, uint64_t first,
                           const std::function<bool(Sample&&)>& deliver);

}  // namespace bevloc::sim
