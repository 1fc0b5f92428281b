#include "common/jpeg_warning.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <turbojpeg.h>

namespace bevloc {
namespace {

using namespace std::string_view_literals;

size_t two_bytes(std::string_view bytes, size_t at) {
  return size_t{static_cast<uint8_t>(bytes[at])} << 8U | static_cast<uint8_t>(bytes[at + 1]);
}

size_t divide_up(size_t dividend, size_t divisor) {
  return (dividend + divisor - 1) / divisor;
}

/// All bytes after the last `start`. Empty if there is no `start`, or if fewer than `size` bytes
/// follow it.
std::string_view after_last(std::string_view bytes, std::string_view start, size_t size) {
  const size_t at = bytes.rfind(start);
  if (at == std::string_view::npos || bytes.size() - at < start.size() + size) return {};
  return bytes.substr(at + start.size());
}

/// The number of parts between restart markers that an image with this head has. 0 if the head is
/// not that of a baseline image of three colours. See ITU-T T.81, B.2.2, B.2.4.4 and A.2.
size_t intervals_of(std::string_view head) {
  const std::string_view frame = after_last(head, "\xFF\xC0\x00\x11\x08"sv, 14);
  if (frame.empty()) return 0;
  const std::string_view restart = after_last(head, "\xFF\xDD\x00\x04"sv, 2);
  const size_t interval = restart.empty() ? 0 : two_bytes(restart, 0);
  if (interval == 0) return 1;
  constexpr size_t kBlock_px = 8;
  // The size of a coding unit (MCU). `interval` is the number of units between two restart markers.
  size_t columns_px = kBlock_px;
  size_t rows_px = kBlock_px;
  for (const size_t colour : {0, 1, 2}) {
    const auto factors = static_cast<uint8_t>(frame[6 + 3 * colour]);
    columns_px = std::max(columns_px, kBlock_px * (factors >> 4U));
    rows_px = std::max(rows_px, kBlock_px * (factors & 0x0FU));
  }
  const size_t units =
      divide_up(two_bytes(frame, 2), columns_px) * divide_up(two_bytes(frame, 0), rows_px);
  return divide_up(units, interval);
}

/// Whether the image has all its restart markers in order, and then the end marker.
bool has_every_marker(std::string_view jpeg) {
  constexpr uint8_t kMarker = 0xFF;
  constexpr uint8_t kData = 0x00;  // 0xFF 0x00 is no marker, but the byte 0xFF of the image
  constexpr uint8_t kRestart = 0xD0;
  constexpr size_t kRestartMarkers = 8;
  constexpr uint8_t kEnd = 0xD9;
  const size_t scan = jpeg.rfind("\xFF\xDA"sv);  // the image data cannot contain this
  if (scan == std::string_view::npos) return false;
  const size_t intervals = intervals_of(jpeg.substr(0, scan));
  size_t restarts = 0;
  for (size_t at = scan + 2; at + 1 < jpeg.size(); ++at) {
    if (static_cast<uint8_t>(jpeg[at]) != kMarker) continue;
    const auto marker = static_cast<uint8_t>(jpeg[at + 1]);
    if (marker == kData || marker == kMarker) continue;
    if (marker == kEnd) return restarts + 1 == intervals;
    if (marker != kRestart + restarts % kRestartMarkers) return false;
    ++restarts;
  }
  return false;
}

}  // namespace

bool is_harmless_warning(void* decompressor, std::string_view jpeg) {
  if (tjGetErrorCode(decompressor) != TJERR_WARNING) return false;
  const std::string_view warning = tjGetErrorStr2(decompressor);
  return warning.find("extraneous bytes before marker") != std::string_view::npos &&
         has_every_marker(jpeg);
}

}  // namespace bevloc
