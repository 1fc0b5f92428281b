// Doubles the number of rows and columns of an image by repeating each pixel.
#pragma once

#include <cstddef>

namespace bevloc::nn {

/// Processes the rows [begin, end) of a dense channel-last image. Each row has `cols` pixels of
/// `pixel_bytes` bytes. `to` is the beginning of the output image.
void upsample_nearest(const std::byte* from, size_t cols, size_t pixel_bytes, size_t begin,
                      size_t end, std::byte* to);

}  // namespace bevloc::nn
