// Makes training samples of recorded framesets, with the daemon's own preprocessing.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/map/map_index.h"
#include "pipeline/map/rasterizer.h"
#include "training/drives/drive_set.h"
#include "training/native/sample_record.h"

namespace bevloc::drives {

/// A sample with its own memory. T is the reference pose, T0 the prior.
struct DriveSample {
  std::vector<uint8_t> images;
  std::vector<uint8_t> raster_prior;
  std::vector<uint8_t> raster_truth;
  ViewTable table;
  Se2 correction;
  CameraMask cameras;

  SampleContent content() const {
    return {images, raster_prior, raster_truth, table, correction, cameras};
  }
};

/// How a training sample differs from its recorded frameset.
struct SampleChoice {
  Se2 correction;  ///< dT = T0^-1 T
  /// The cameras that the sample shows; the others are black, as if missing. If the frameset has
  /// none of these cameras, the sample shows all cameras of the frameset.
  CameraMask cameras;
};

/// Draws the choice number `sample` of a seed: a correction of up to 2 m, 1 m and 2 degrees, and
/// with this probability one or two missing cameras, as the simulator does.
SampleChoice random_choice(uint64_t seed, uint64_t sample, double drop_camera_probability);

/// Makes samples from framesets of a set. One thread. Set and map must outlive this object.
class DriveSampleMaker {
 public:
  DriveSampleMaker(DriveSet& set, const MapIndex& map);

  /// Fails if an image that the sample needs is missing or damaged, if a camera exposed more than
  /// kWidestSpread from the others, if the reference has no pose there, or if the map has nothing
  /// there. The reference time is the earliest exposure.
  Status make(const SamplePlace& place, const SampleChoice& choice, DriveSample& sample);

 private:
  struct Cameras {
    std::vector<ImagePreprocessor> preprocessors;
    Rig network_rig;
  };

  Status read_images(const SamplePlace& place, const CameraMask& wanted, DriveSample& sample,
                     std::array<Time, kCameraCount>& exposures);

  DriveSet& set_;
  std::vector<Cameras> cameras_;  ///< of each drive
  MapRasterizer rasterizer_;
  std::vector<int8_t> planes_;
};

}  // namespace bevloc::drives
