// Reads a model file: standard ONNX, operator set 13 or newer.
#pragma once

#include <string>

#include "pipeline/network/graph.h"

namespace bevloc::nn {

/// Throws LoadError for a file that is missing or cut off, and, by name, for an operator, an
/// attribute or an element type that the executor does not know.
Graph read_onnx(const std::string& path);

}  // namespace bevloc::nn
