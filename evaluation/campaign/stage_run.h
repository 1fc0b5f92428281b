// One run on the stage level: the estimation stage and its neighbours on the bus, with the modelled
// matcher in place of pictures and network.
#pragma once

#include <functional>

#include "common/result.h"
#include "evaluation/campaign/cycle_reader.h"
#include "evaluation/campaign/match_table.h"
#include "evaluation/campaign/modes/mode.h"
#include "evaluation/drive/drive_config.h"

namespace bevloc::evaluation {

using CycleSink = std::function<void(const JudgedCycle&)>;

/// Drives through the world of `config.simulation` (which must be set) on a virtual clock, with the
/// faults of the mode: the simulated vehicle sends odometry and GNSS on a mock bus; the vehicle
/// input stage, the estimation stage and the publisher are those of the appliance. Calls `sink`
/// after each bus cycle. Fails if the world cannot be made.
Status run_stage(const DriveConfig& config, const Mode& mode, const MatchTable& table,
                 const CycleSink& sink);

}  // namespace bevloc::evaluation
