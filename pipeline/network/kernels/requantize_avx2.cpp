// Requantization with AVX2.
#include "common/cpu_features.h"
#include "pipeline/network/kernels/requantize.h"

#ifdef __x86_64__
#include <cstring>
#include <type_traits>

#include <immintrin.h>

#pragma GCC target("avx2")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_avx2.h"
#include "pipeline/network/kernels/requantize_body.h"

}  // namespace

Requantize requantize_vector(ElementType output, ElementType residual, bool has_residual) {
  if (!has_avx2()) return nullptr;
  return requantize_by_type(output, residual, has_residual);
}

}  // namespace bevloc::nn
#endif
