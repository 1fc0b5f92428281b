// Requantization with NEON, which every arm64 processor has.
#include "pipeline/network/kernels/requantize.h"

#ifdef __aarch64__
#include <algorithm>
#include <array>
#include <type_traits>

#include <arm_neon.h>

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_neon.h"
#include "pipeline/network/kernels/requantize_body.h"

}  // namespace

Requantize requantize_vector(ElementType output, ElementType residual, bool has_residual) {
  return requantize_by_type(output, residual, has_residual);
}

}  // namespace bevloc::nn
#endif
