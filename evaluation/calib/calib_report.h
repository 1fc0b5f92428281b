// What `bevloc calib check` and `bevloc calib refine` say, as text and as JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "pipeline/calibration/refine/refinement.h"

namespace bevloc::evaluation {

/// What a check of a picture folder found.
struct CalibrationCheck {
  RigRefinement refinement;  ///< only rotations were free
  std::string folder;
  CameraMask recorded;  ///< the cameras that have pictures in the folder
};

enum class CameraVerdict : uint8_t {
  kGood,       ///< paint lies where the map says
  kOff,        ///< paint would lie there if the camera were turned a little
  kMismatch,   ///< the paint found does not fit the map: another camera, map or mounting
  kTooLittle,  ///< too little paint to tell
  kNoPictures  ///< the folder has no pictures of this camera
};

/// Judges a camera that has pictures from a refinement in which only rotations were free.
/// `best_share`: the largest share of found paint of all cameras.
CameraVerdict verdict_on(const CameraRefinement& camera, double best_share);

/// Whether each camera with pictures is good, and there is one.
bool all_good(const CalibrationCheck& check);

std::string text_of(const CalibrationCheck& check);
std::string text_of(const RigRefinement& refinement);
/// A line for each camera whose time offset was found, because a rig file cannot hold it.
std::string time_offsets_of(const RigRefinement& refinement);
nlohmann::json json_of(const RigRefinement& refinement);
/// With a verdict on each camera.
nlohmann::json json_of(const CalibrationCheck& check);

}  // namespace bevloc::evaluation
