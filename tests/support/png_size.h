// The size of a PNG file.
#pragma once

#include <string_view>

namespace bevloc::test {

struct SizePx {
  int width = 0;
  int height = 0;
};

/// Reads the size from the IHDR chunk, which begins a PNG file. Returns 0 x 0 if it is incomplete.
inline SizePx png_size(std::string_view png) {
  if (png.size() < 24) return {};
  const auto number = [&](size_t at) {
    int value = 0;
    for (size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(png[i]);
    return value;
  };
  return {number(16), number(20)};
}

}  // namespace bevloc::test
