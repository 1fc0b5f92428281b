// The engine that uses oneDNN. oneDNN compiles its kernels for the CPU at load.
#pragma once

#include "pipeline/network/engines/engine.h"

namespace bevloc::nn {

/// Our code does not allocate in run(), but oneDNN 2.6 allocates a small table of arguments for
/// each primitive that it executes. A branch uses `threads` OpenMP threads. The cap on the
/// instruction set applies to the whole process; a request for another cap throws LoadError.
MakeEngine make_onednn_engine;

}  // namespace bevloc::nn
