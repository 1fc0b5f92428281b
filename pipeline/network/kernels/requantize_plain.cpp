// Requantization in plain C++, and the choice between it and AVX2.
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

#ifndef __x86_64__
Requantize requantize_avx2(ElementType, ElementType, bool) {
  return nullptr;
}
#endif

Requantize requantize_for(const Requantizer& requantizer, bool has_residual) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) {
    return requantize_avx2(requantizer.output, requantizer.residual, has_residual);
  }
#endif
  return requantize_plain(requantizer.output, requantizer.residual, has_residual);
}

}  // namespace bevloc::nn
