// The engine on XNNPACK, whose kernels are compiled ahead: small, and at home on arm64.
#pragma once

#include "pipeline/network/engine.h"

namespace bevloc::nn {

/// run() allocates nothing; with one thread it locks nothing, with more pthreadpool does. XNNPACK
/// chooses its instructions itself: a cap is refused.
MakeEngine make_xnnpack_engine;

}  // namespace bevloc::nn
