// What a model states about the cameras that it was trained with, and whether a rig is like them.
#pragma once

#include <array>
#include <optional>

#include "common/cameras.h"
#include "common/result.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/network/model/graph.h"

namespace bevloc {

/// Numbers for each camera, in the order of kCameraNames.
using PerCamera = std::array<double, kCameraCount>;

/// The least and the largest value that occurred in training.
struct TrainedRange {
  double least = 0.0;
  double most = 0.0;
};

/// Statements that the model does not make are empty.
struct ModelRig {
  std::optional<PerCamera> focal_px;  ///< focal lengths of the network cameras (network_camera.h)
  std::optional<PerCamera> height_m;  ///< heights of the cameras above the ground
  // The ranges over the rigs of all samples, if the rigs differed.
  std::optional<TrainedRange> focal_range_px;
  std::optional<TrainedRange> height_range_m;
};

/// Reads the optional metadata bevloc.rig.cameras (names in the order of the images),
/// bevloc.rig.image_size_px, bevloc.rig.focal_px, bevloc.rig.height_m, bevloc.rig.focal_range_px
/// and bevloc.rig.height_range_m: words with blanks between them. Throws nn::LoadError if a value
/// has another form, or if the names or the size are not those of the network's input.
ModelRig read_model_rig(const nn::Graph& graph);

/// Fails, with the camera in the message, if a focal length or a height differs from the model's by
/// more than a factor of 1.5 and lies outside of the range of training.
Status check_rig_fits(const ModelRig& model, const Rig& rig);

}  // namespace bevloc
