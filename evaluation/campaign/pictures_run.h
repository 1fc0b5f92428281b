// One run on the pictures level: the whole appliance in lockstep, with mock cameras.
#pragma once

#include <memory>

#include "common/result.h"
#include "drivers/mock/picture_cache.h"
#include "evaluation/campaign/stage_run.h"
#include "evaluation/drive/drive_config.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

/// Drives through the world of `config.simulation` (which must be set) with its faults, and calls
/// `sink` after each bus cycle. `pictures`: shares the drawn pictures with other runs, which may
/// have other faults; null without a cache. Fails if the world or the appliance cannot be made.
Status run_pictures(const DriveConfig& config, const Rig& rig,
                    const std::shared_ptr<drivers::PictureCache>& pictures, const CycleSink& sink);

}  // namespace bevloc::evaluation
