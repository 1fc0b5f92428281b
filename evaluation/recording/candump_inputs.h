// What a candump log and folders of pictures give to a replay.
#pragma once

#include <filesystem>

#include "evaluation/recording/replay.h"

namespace bevloc::evaluation {

/// Frames of a candump log, and for each camera a folder of `images` with pictures and frames.txt.
/// The times of both are of one clock. Refuses a log with a gap of more than a minute, or with a
/// line that goes back by more than a second.
Result<ReplayInputs> inputs_of_candump(const std::filesystem::path& log,
                                       const std::filesystem::path& images,
                                       const ReplaySetup& setup);

}  // namespace bevloc::evaluation
