// The view transform in plain C++, and the choice between it and vector instructions.
#include <algorithm>
#include <array>
#include <limits>

#include "pipeline/network/kernels/view_gather.h"
#include "pipeline/network/kernels/view_transform.h"

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/lanes_plain.h"
#include "pipeline/network/kernels/view_gather_body.h"

}  // namespace

Gather gather_plain(ElementType input, ElementType output) {
  return gather_by_type(input, output);
}

Gather gather_for(ElementType input, ElementType output) {
  const Gather vector = gather_vector(input, output);
  return vector != nullptr ? vector : gather_plain(input, output);
}

}  // namespace bevloc::nn
