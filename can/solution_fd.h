// Joins the classic frames of a solution into its FD frame, and parts them again.
#pragma once

#include <cstddef>

#include "can/frame.h"
#include "can/message_table.h"
#include "can/solution_frames.h"

namespace bevloc::can {

/// The LOC_Solution with the content of these frames, not protected yet.
Frame joined_solution(const Frame& status, const SolutionFrames& frames, const BaseIds& base);

/// The classic frame of loc_solution::kParts[part] with the content that `solution` has of it and
/// an E2E header of zeros. `solution` has the length of a LOC_Solution.
Frame part_of_solution(const Frame& solution, size_t part, const BaseIds& base);

}  // namespace bevloc::can
