// Twice as many rows and columns, each cell repeated.
#pragma once

#include <cstddef>

namespace bevloc::nn {

/// Rows [begin, end) of a dense channel-last input with `cols` pixels of `pixel_bytes` in each.
void upsample_nearest(const std::byte* from, size_t cols, size_t pixel_bytes, size_t begin,
                      size_t end, std::byte* to);

}  // namespace bevloc::nn
