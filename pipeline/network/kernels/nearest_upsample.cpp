#include "pipeline/network/kernels/nearest_upsample.h"

#include <cstring>

namespace bevloc::nn {

void upsample_nearest(const std::byte* from, size_t cols, size_t pixel_bytes, size_t begin,
                      size_t end, std::byte* to) {
  const size_t line_bytes = 2 * cols * pixel_bytes;
  for (size_t row = begin; row < end; ++row) {
    std::byte* const line = to + 2 * row * line_bytes;
    for (size_t col = 0; col < 2 * cols; ++col) {
      std::memcpy(line + col * pixel_bytes, from + (row * cols + col / 2) * pixel_bytes,
                  pixel_bytes);
    }
    std::memcpy(line + line_bytes, line, line_bytes);
  }
}

}  // namespace bevloc::nn
