// The view transform in plain C++, and the choice between it and AVX2.
#include <algorithm>
#include <array>
#include <limits>

#include "pipeline/network/kernels/view_gather.h"
#include "pipeline/network/view/view_transform.h"

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_plain.h"
#include "pipeline/network/kernels/view_gather_body.h"

}  // namespace

Gather gather_plain(ElementType input, ElementType output) {
  return gather_by_type(input, output);
}

#ifndef __x86_64__
Gather gather_avx2(ElementType, ElementType) {
  return nullptr;
}
#endif

Gather gather_for(ElementType input, ElementType output) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) return gather_avx2(input, output);
#endif
  return gather_plain(input, output);
}

}  // namespace bevloc::nn
