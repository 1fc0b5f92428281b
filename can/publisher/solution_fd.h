// Joins the classic frames of a solution into one FD frame, and splits the FD frame again.
#pragma once

#include <cstddef>

#include "can/bus/frame.h"
#include "can/messages/message_table.h"
#include "can/publisher/solution_frames.h"

namespace bevloc::can {

/// Returns a LOC_Solution frame with the content of these frames. It is not protected yet.
Frame joined_solution(const Frame& status, const SolutionFrames& frames, const Frame& identity,
                      const BaseIds& base);

/// Returns the classic frame of loc_solution::kParts[part] with its content in `solution` and with
/// an E2E header of zeros. `solution` must have the length of LOC_Solution.
Frame part_of_solution(const Frame& solution, size_t part, const BaseIds& base);

}  // namespace bevloc::can
