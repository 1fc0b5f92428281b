#include "common/exif_orientation.h"

#include <cstddef>
#include <cstdint>

namespace bevloc {
namespace {

/// A part of a file, whose numbers have one byte order. Every access checks the bounds.
class Bytes {
 public:
  Bytes(std::string_view bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  std::optional<uint32_t> number(size_t at, size_t size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    uint32_t value = 0;
    for (size_t i = 0; i < size; ++i) {
      const size_t next = big_endian_ ? at + i : at + size - 1 - i;
      value = value << 8U | static_cast<uint8_t>(bytes_[next]);
    }
    return value;
  }

 private:
  std::string_view bytes_;
  bool big_endian_;
};

/// The TIFF file of the first segment with EXIF data. Empty if there is none.
std::string_view tiff_in(std::string_view jpeg) {
  constexpr std::string_view kExif("Exif\0\0", 6);
  constexpr uint32_t kApp1 = 0xE1;
  constexpr uint32_t kStartOfScan = 0xDA;
  constexpr uint32_t kEndOfImage = 0xD9;
  constexpr uint32_t kFill = 0xFF;
  constexpr size_t kMarkerBytes = 2;
  constexpr size_t kLengthBytes = 2;
  const Bytes bytes(jpeg, true);
  size_t at = kMarkerBytes;  // after the start of the image
  while (bytes.number(at, 1) == kFill) {
    const auto marker = bytes.number(at + 1, 1);
    if (marker == kFill) {
      ++at;
      continue;
    }
    const auto length = bytes.number(at + kMarkerBytes, kLengthBytes);
    const bool is_over = marker == kStartOfScan || marker == kEndOfImage;
    if (is_over || !length || *length < kLengthBytes) return {};
    const std::string_view segment = jpeg.substr(at + kMarkerBytes, *length).substr(kLengthBytes);
    if (marker == kApp1 && segment.starts_with(kExif)) return segment.substr(kExif.size());
    at += kMarkerBytes + *length;
  }
  return {};
}

}  // namespace

std::optional<int> exif_orientation(std::string_view jpeg) {
  constexpr uint32_t kOrientation = 0x0112;
  constexpr uint32_t kShort = 3;  // type of two bytes
  constexpr uint32_t kLargest = 8;
  constexpr size_t kEntryBytes = 12;
  const std::string_view tiff = tiff_in(jpeg);
  const bool big_endian = tiff.starts_with("MM");
  if (!big_endian && !tiff.starts_with("II")) return std::nullopt;
  const Bytes bytes(tiff, big_endian);
  const auto directory = bytes.number(4, 4);
  if (!directory) return std::nullopt;
  const uint32_t entries = bytes.number(*directory, 2).value_or(0);
  for (uint32_t i = 0; i < entries; ++i) {
    const size_t entry = size_t{*directory} + 2 + kEntryBytes * i;
    const auto tag = bytes.number(entry, 2);
    if (!tag) return std::nullopt;
    if (tag != kOrientation) continue;
    const auto value = bytes.number(entry + 8, 2);
    const bool is_valid = bytes.number(entry + 2, 2) == kShort && value && *value >= 1;
    if (!is_valid || *value > kLargest) return std::nullopt;
    return static_cast<int>(*value);
  }
  return std::nullopt;
}

}  // namespace bevloc
