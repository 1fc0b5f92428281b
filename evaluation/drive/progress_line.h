// Shows the progress of a simulated drive on stderr.
#pragma once

#include "evaluation/drive/judge.h"
#include "firmware/runtime/supervisor.h"

namespace bevloc::evaluation {

/// Overwrites the line on a terminal. Writes only the last line to a file or pipe.
void show_progress_line(const firmware::ApplianceView& appliance, const JudgeView& judge,
                        double time_s, double duration_s, bool last);

}  // namespace bevloc::evaluation
