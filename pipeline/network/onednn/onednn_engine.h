// The engine on oneDNN, which compiles kernels for the CPU at load.
#pragma once

#include "pipeline/network/engine.h"

namespace bevloc::nn {

/// run() allocates nothing of its own; oneDNN 2.6 makes a small table of arguments for each
/// primitive it executes. A branch uses `threads` OpenMP threads. The cap of the instruction set
/// holds for the whole process: another one later is refused.
MakeEngine make_onednn_engine;

}  // namespace bevloc::nn
