// Measures matches on simulated pictures, for the modelled matcher of the campaign.
#pragma once

#include <cstdint>
#include <functional>

#include "evaluation/campaign/match_table.h"
#include "evaluation/drive/drive_config.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// Drives through the world of `config.simulation` (which must be set) and matches every frameset
/// from several priors around the true pose, with the configuration's model and solver:
/// - always one prior with the tracking range, as far off as a tracked pose may be;
/// - always one with the tracking range, for which the truth lies near the border of that range or
///   beyond it, up to 3.5 ranges away, along one axis (x, y and yaw in turn);
/// - in every second frameset one with the acquiring range, within that range;
/// - in every fourth frameset one with the acquiring range, near the border of that range or beyond
///   it, up to 2 ranges away.
/// No tracker is involved: a recorded error belongs to a place and a prior. `drive` is the number
/// that the places get. The pictures show the configuration's street, but no photographs and no
/// faults. Fails for a street with photographs, and if the model, the rig or the map cannot be
/// used.
Result<std::vector<MeasuredPlace>> record_matches(const DriveConfig& config, const Rig& rig,
                                                  int drive,
                                                  const std::function<void(double)>& at_time_s);

}  // namespace bevloc::evaluation
