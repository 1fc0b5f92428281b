// From a convolution's integer sums to the elements of its output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/network/graph.h"

namespace bevloc::nn {

/// output = round(sum * scale + residual * residual_scale), cut off at the output type's range;
/// what is negative becomes 0 if `relu`. Rounds half to even. The same on every CPU. Real results
/// must fit into an int32.
struct Requantizer {
  int channels = 0;
  std::vector<float> scale;  ///< of the sum, in units of the output, by channel
  ElementType output = ElementType::kUint8;
  ElementType residual = ElementType::kUint8;
  float residual_scale = 0.0F;
  bool relu = false;
};

/// A row of pixels: `sums` has `sums_step` elements for each, no fewer than the channels rounded up
/// to eight; all else is dense.
struct RequantizedRow {
  const int32_t* sums = nullptr;
  std::ptrdiff_t sums_step = 0;
  int pixels = 0;
  const std::byte* residual = nullptr;  ///< null without one
  std::byte* output = nullptr;
};

using Requantize = void (*)(const Requantizer&, const RequantizedRow&);

/// The fastest that this CPU can run.
Requantize requantize_for(const Requantizer& requantizer, bool has_residual);

/// By instruction set; the AVX2 one is null elsewhere.
Requantize requantize_plain(ElementType output, ElementType residual, bool has_residual);
Requantize requantize_avx2(ElementType output, ElementType residual, bool has_residual);

}  // namespace bevloc::nn
