// Lowers the operators that slide a window over an image: Conv and MaxPool.
#pragma once

#include "pipeline/network/model/lowering_state.h"

namespace bevloc::nn {

/// Each function throws LoadError if the node uses the operator in a way that is not supported.
void lower_conv(LoweringState& state, const Node& node);
void lower_max_pool(LoweringState& state, const Node& node);

}  // namespace bevloc::nn
