// Makes simulated samples for training and evaluation: camera images at a pose, the map raster at
// that pose, and the map raster at a prior that is off by a known correction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/se2.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/preprocessing/network_camera.h"
#include "sim/random.h"
#include "sim/samples/nuisances.h"
#include "sim/samples/training_nuisances.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {

/// Number of consecutive samples that share one world, because making a world is expensive.
inline constexpr uint64_t kSamplesPerWorld = 16;

/// World seeds for the evaluation of networks. They lie above the small seeds of demos, tests and
/// training's validation, and below those of matching scenes (sim/perception/matching_scene.h).
inline constexpr uint64_t kSampleSeedCount = 1ULL << 30U;
inline constexpr uint64_t kEvaluationSampleSeedBase = 1ULL << 30U;
static_assert(kEvaluationSampleSeedBase + kSampleSeedCount <= kFirstTrainingSeed);

/// Number of bytes of a sample's images: [camera, colour, row, column].
inline constexpr size_t kImagesSize =
    static_cast<size_t>(kCameraCount) * 3 * kNetworkHeightPx * kNetworkWidthPx;

/// T is the true pose, T0 the prior.
struct Sample {
  std::vector<uint8_t> images;              ///< kImagesSize bytes; black where a camera is missing
  Rig rig;                                  ///< the network's rig as calibrated
  CameraMask cameras;                       ///< the cameras that are present
  CameraMotions reference_from_exposure{};  ///< motion against the time of T, from odometry
  std::vector<uint8_t> raster_prior;        ///< the localizer's map at T0, kRasterSize bytes
  std::vector<uint8_t> raster_truth;        ///< the world's own map at T, kRasterSize bytes
  Se2 correction;                           ///< dT = T0^-1 T
};

/// An endless stream of samples. Sample i depends on the stream and i alone. Streams that differ
/// only in their nuisances show the same places from the same poses.
struct SampleStream {
  uint64_t first_seed = 0;
  Nuisances nuisances;
  /// If set, every world is this map, dressed anew; it must have lanes. If null, worlds are
  /// generated towns.
  const HdMap* map = nullptr;
  /// If set, the vehicle has these cameras instead of the simulator's own, except in samples with a
  /// Nuisances::rig_variety. Their distortion does not count, because the network's images are
  /// rendered directly. Pixels outside of their images or on the own vehicle are black.
  const Rig* rig = nullptr;
  /// If set, these photographs cover surfaces of every world. They must outlive the stream.
  const PhotoLibrary* photos = nullptr;
  /// Stronger nuisances in a share of the samples, on top of `nuisances`.
  TrainingNuisances training{};
};

/// Draws the correction of a prior: uniform up to 2 m, 1 m and 2 degrees (paper, section IV-A).
Se2 random_correction(Random& random);
/// Draws which cameras are present.
CameraMask random_cameras(const MissingCameras& missing, Random& random);

/// The network's rig of the simulator's own vehicle. The cameras that take a sample's images differ
/// from the sample's rig by the calibration error.
const Rig& nominal_network_rig();

/// Makes the samples of one world and passes each to `deliver`. World w holds the samples from
/// w * kSamplesPerWorld on; `first` is the number of the first one within the world. Stops early if
/// `deliver` returns false.
void make_samples_of_world(const SampleStream& stream, uint64_t world_number, uint64_t first,
                           const std::function<bool(Sample&&)>& deliver);

}  // namespace bevloc::sim
