// Lowers the graph of a model to the steps of a program.
#pragma once

#include "pipeline/network/model/graph.h"
#include "pipeline/network/model/program.h"

namespace bevloc::nn {

/// Folds QuantizeLinear and DequantizeLinear into the neighbouring steps, sums and ReLU into
/// convolutions, data movement into as few copies as possible, and Gather, Mul and ReduceSum into
/// the view transform. Whatever cannot be folded becomes a step of its own, so the results are
/// always those of the graph.
///
/// Throws LoadError, with the name of the node, if an operator is used in a way that is not
/// supported.
Program lower(const Graph& graph);

}  // namespace bevloc::nn
