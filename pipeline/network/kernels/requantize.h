// Converts the integer sums of a convolution to the elements of its output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/network/model/graph.h"

namespace bevloc::nn {

/// output = round(sum * scale + residual * residual_scale), then ReLU if `relu` is set, saturated
/// to the range of the output type. Rounds half to even. Gives the same result on every CPU. The
/// value before rounding must fit into an int32. Float outputs are not rounded.
struct Requantizer {
  int channels = 0;
  std::vector<float> scale;  ///< by channel: value of one unit of the sum, in units of the output
  ElementType output = ElementType::kUint8;
  ElementType residual = ElementType::kUint8;
  float residual_scale = 0.0F;
  bool relu = false;
};

/// One row of pixels. Each pixel has `sums_step` sums, at least the number of channels rounded up
/// to eight. Residual and output are dense.
struct RequantizedRow {
  const int32_t* sums = nullptr;
  std::ptrdiff_t sums_step = 0;
  int pixels = 0;
  const std::byte* residual = nullptr;  ///< null without a residual
  std::byte* output = nullptr;
};

using Requantize = void (*)(const Requantizer&, const RequantizedRow&);

/// The fastest function that this CPU supports.
Requantize requantize_for(const Requantizer& requantizer, bool has_residual);

/// The function in plain C++, and the one with vector instructions (AVX2 or NEON). The latter is
/// null on a CPU without them.
Requantize requantize_plain(ElementType output, ElementType residual, bool has_residual);
Requantize requantize_vector(ElementType output, ElementType residual, bool has_residual);

}  // namespace bevloc::nn
