// From the model's graph to the steps that the executor runs.
#pragma once

#include "pipeline/network/graph.h"
#include "pipeline/network/program.h"

namespace bevloc::nn {

/// Folds QuantizeLinear and DequantizeLinear into the steps around them, sums and ReLU into
/// convolutions, data movement into as few copies as possible, and Gather-Mul-ReduceSum into the
/// view transform. What it cannot fold it computes separately: the values are those of the graph.
/// Throws LoadError, naming the node, for a use of an operator that the executor does not know.
Program lower(const Graph& graph);

}  // namespace bevloc::nn
