// JPEG images with restart markers, as USB cameras send them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace bevloc::test {

/// While it exists, TurboJPEG writes a restart marker after each row of blocks.
class RestartMarkers {
 public:
  RestartMarkers() { setenv("TJ_RESTART", "1", 1); }
  ~RestartMarkers() { unsetenv("TJ_RESTART"); }
  RestartMarkers(const RestartMarkers&) = delete;
  RestartMarkers& operator=(const RestartMarkers&) = delete;
};

constexpr uint8_t kEndMarker = 0xD9;

constexpr uint8_t restart_marker(int number) {
  return static_cast<uint8_t>(0xD0 + number);
}

/// Where the marker begins, or the size of the image if it has none. `Bytes` is a string or vector.
template <typename Bytes>
size_t place_of(uint8_t marker, const Bytes& jpeg) {
  for (size_t at = 0; at + 1 < jpeg.size(); ++at) {
    const bool is_found =
        static_cast<uint8_t>(jpeg[at]) == 0xFF && static_cast<uint8_t>(jpeg[at + 1]) == marker;
    if (is_found) return at;
  }
  return jpeg.size();
}

}  // namespace bevloc::test
