// Whether a JPEG file from a camera arrived whole.
#pragma once

#include <cstdint>
#include <span>

namespace bevloc::drivers {

/// Begins with the marker SOI and ends with EOI (ITU-T T.81, B.1.1.3); cameras may pad with zeros.
inline bool is_whole_jpeg(std::span<const uint8_t> file) {
  constexpr uint8_t kMarker = 0xFF;
  constexpr uint8_t kStartOfImage = 0xD8;
  constexpr uint8_t kEndOfImage = 0xD9;
  while (!file.empty() && file.back() == 0) file = file.first(file.size() - 1);
  return file.size() > 4 && file[0] == kMarker && file[1] == kStartOfImage &&
         file[file.size() - 2] == kMarker && file.back() == kEndOfImage;
}

}  // namespace bevloc::drivers
