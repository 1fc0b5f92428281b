// The arithmetic that XNNPACK has no operator for: residual, ReLU and rounding after a convolution,
// sums of two activations, ReLU alone, and conversions to another scale or type.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/network/engines/xnnpack/task.h"

namespace bevloc::nn::xnnpack {

/// The elements of one storage, with the real values scale * (element - zero point).
struct Term {
  size_t storage = 0;
  ElementType type = ElementType::kFloat32;
  std::vector<float> scale;  ///< one per channel, or one for all
};

/// output = left + right in real values, then ReLU. An 8-bit output is rounded once, to nearest
/// even, and saturated. The output may be the storage of a term with elements of the same size.
struct Sum {
  Term left;
  std::optional<Term> right;  ///< must have one scale for all channels
  size_t output = 0;
  ElementType output_type = ElementType::kFloat32;
  float output_scale = 1.0F;
  bool relu = false;
  size_t pixels = 0;
  size_t channels = 0;
};

std::unique_ptr<Task> make_sum(const Sum& sum);

}  // namespace bevloc::nn::xnnpack
