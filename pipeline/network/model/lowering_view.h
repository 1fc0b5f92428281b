// Lowers the view transform: Gather by view_index, Mul by view_weight, ReduceSum over the slots.
// The axes may have any order, because lowering compares the elements and not the shapes.
#pragma once

#include "pipeline/network/model/lowering_state.h"

namespace bevloc::nn {

/// Each function throws LoadError if the node is not part of a view transform.
void lower_gather(LoweringState& state, const Node& node);
void lower_mul(LoweringState& state, const Node& node);
void lower_reduce_sum(LoweringState& state, const Node& node);

}  // namespace bevloc::nn
