// Lowers QuantizeLinear and DequantizeLinear: folds them into the steps around them.
#pragma once

#include "pipeline/network/model/lowering_state.h"

namespace bevloc::nn {

/// Each function throws LoadError if the node uses the operator in a way that is not supported.
void lower_quantize(LoweringState& state, const Node& node);
void lower_dequantize(LoweringState& state, const Node& node);

}  // namespace bevloc::nn
