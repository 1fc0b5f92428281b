// Copies elements in another order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace bevloc::nn {

/// to[i] = from[source[i]] for each i in [begin, end). Elements have 1 or 4 bytes.
void rearrange(const std::vector<int32_t>& source, size_t element_bytes, const std::byte* from,
               std::byte* to, size_t begin, size_t end);

}  // namespace bevloc::nn
