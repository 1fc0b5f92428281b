// The engine that uses XNNPACK, a small library with precompiled kernels.
#pragma once

#include "pipeline/network/engines/engine.h"

namespace bevloc::nn {

/// run() does not allocate. It does not lock with one thread; with several, pthreadpool locks.
/// XNNPACK selects its instructions itself, so a cap other than IsaCap::kBest throws LoadError.
MakeEngine make_xnnpack_engine;

}  // namespace bevloc::nn
