// Reads a model file: standard ONNX, operator set 13 or newer.
#pragma once

#include <string>
#include <string_view>

#include "pipeline/network/model/graph.h"

namespace bevloc::nn {

/// Throws LoadError if the file is missing or truncated, or if it uses an operator, an attribute or
/// an element type that is not supported (the message names it).
Graph read_onnx(const std::string& path);

/// Does the same for a file in memory.
Graph parse_onnx(std::string_view bytes);

}  // namespace bevloc::nn
