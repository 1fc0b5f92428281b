// The view transform with AVX2.
#include "common/cpu_features.h"
#include "pipeline/network/kernels/view_gather.h"
#include "pipeline/network/kernels/view_transform.h"

#ifdef __x86_64__
#include <cstring>

#include <immintrin.h>

#pragma GCC target("avx2")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_avx2.h"
#include "pipeline/network/kernels/view_gather_body.h"

}  // namespace

Gather gather_vector(ElementType input, ElementType output) {
  if (!has_avx2()) return nullptr;
  return gather_by_type(input, output);
}

}  // namespace bevloc::nn
#endif
