#include "pipeline/network/kernels/rearrange.h"

#include <cassert>
#include <cstring>

namespace bevloc::nn {
namespace {

template <size_t kBytes>
void rearrange_elements(const int32_t* source, const std::byte* from, std::byte* to, size_t count) {
#pragma GCC unroll 8
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(to + i * kBytes, from + static_cast<size_t>(source[i]) * kBytes, kBytes);
  }
}

}  // namespace

void rearrange(const std::vector<int32_t>& source, size_t element_bytes, const std::byte* from,
               std::byte* to, size_t begin, size_t end) {
  assert(element_bytes == 1 || element_bytes == 4);
  const auto move = element_bytes == 1 ? rearrange_elements<1> : rearrange_elements<4>;
  move(source.data() + begin, from, to + begin * element_bytes, end - begin);
}

}  // namespace bevloc::nn
