// One live line about a simulated drive.
#pragma once

#include "firmware/simulation/judge.h"
#include "firmware/supervisor.h"

namespace bevloc::firmware {

/// Overwrites the line on a terminal; elsewhere (a log, a pipe) only the last one is written.
void show_progress_line(const ApplianceView& appliance, const JudgeView& judge, double time_s,
                        double duration_s, bool last);

}  // namespace bevloc::firmware
