// What `bevloc calib check` and `bevloc calib refine` say, as text and as JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "pipeline/calibration/refine/refinement.h"

namespace bevloc::evaluation {

enum class CameraVerdict : uint8_t {
  kGood,      ///< paint lies where the map says
  kOff,       ///< paint would lie there if the camera were turned a little
  kMismatch,  ///< the paint found does not fit the map: another camera, map or mounting
  kTooLittle  ///< too little paint to tell
};

/// Judges a camera from a refinement in which only rotations were free. `best_share`: the largest
/// share of found paint of all cameras.
CameraVerdict verdict_on(const CameraRefinement& camera, double best_share);

/// Whether each camera is good.
bool all_good(const RigRefinement& checked);

std::string text_of_check(const RigRefinement& checked);
std::string text_of_refinement(const RigRefinement& refinement);
/// `with_verdicts`: whether to add a verdict on each camera, as for a check.
nlohmann::json json_of(const RigRefinement& refinement, bool with_verdicts);

}  // namespace bevloc::evaluation
