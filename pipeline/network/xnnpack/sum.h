// The arithmetic that XNNPACK has no operator for, in one pass: what follows a sum of products
// (residual, ReLU, rounding), sums of two activations, ReLU alone, other scales and types.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/network/xnnpack/task.h"

namespace bevloc::nn::xnnpack {

/// Elements of one storage and what they stand for: scale * (element - zero point).
struct Term {
  size_t storage = 0;
  ElementType type = ElementType::kFloat32;
  std::vector<float> scale;  ///< by channel, or one for all
};

/// output = left + right in real values, then ReLU. Rounded once, to nearest even, and saturated
/// where the output is 8 bits wide. The output may be the storage of a term of the same width.
struct Sum {
  Term left;
  std::optional<Term> right;  ///< with one scale
  size_t output = 0;
  ElementType output_type = ElementType::kFloat32;
  float output_scale = 1.0F;
  bool relu = false;
  size_t pixels = 0;
  size_t channels = 0;
};

std::unique_ptr<Task> make_sum(const Sum& sum);

}  // namespace bevloc::nn::xnnpack
