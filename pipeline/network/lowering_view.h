// Recognises the view transform: Gather by view_index, Mul by view_weight, ReduceSum over slots.
// Any arrangement of the axes is accepted: what counts is which element meets which.
#pragma once

#include "pipeline/network/lowering_state.h"

namespace bevloc::nn {

/// Each throws LoadError for a use outside the view transform.
void lower_gather(LoweringState& state, const Node& node);
void lower_mul(LoweringState& state, const Node& node);
void lower_reduce_sum(LoweringState& state, const Node& node);

}  // namespace bevloc::nn
