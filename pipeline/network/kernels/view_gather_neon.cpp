// The view transform with NEON, which every arm64 processor has.
#include "pipeline/network/kernels/view_gather.h"
#include "pipeline/network/kernels/view_transform.h"

#ifdef __aarch64__
#include <algorithm>
#include <array>

#include <arm_neon.h>

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_neon.h"
#include "pipeline/network/kernels/view_gather_body.h"

}  // namespace

Gather gather_vector(ElementType input, ElementType output) {
  return gather_by_type(input, output);
}

}  // namespace bevloc::nn
#endif
