// The view transform with AVX2.
#include "pipeline/network/kernels/view_gather.h"
#include "pipeline/network/view/view_transform.h"

#ifdef __x86_64__
#include <cstring>

#include <immintrin.h>

#pragma GCC target("avx2")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_avx2.h"
#include "pipeline/network/kernels/view_gather_body.h"

}  // namespace

Gather gather_avx2(ElementType input, ElementType output) {
  return gather_by_type(input, output);
}

}  // namespace bevloc::nn
#endif
