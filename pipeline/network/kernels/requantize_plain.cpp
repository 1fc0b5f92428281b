// Requantization in plain C++, and the choice between it and vector instructions.
#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

#include "pipeline/network/kernels/requantize.h"

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_plain.h"
#include "pipeline/network/kernels/requantize_body.h"

}  // namespace

Requantize requantize_plain(ElementType output, ElementType residual, bool has_residual) {
  return requantize_by_type(output, residual, has_residual);
}

Requantize requantize_for(const Requantizer& r, bool has_residual) {
  const Requantize vector = requantize_vector(r.output, r.residual, has_residual);
  return vector != nullptr ? vector : requantize_plain(r.output, r.residual, has_residual);
}

}  // namespace bevloc::nn
