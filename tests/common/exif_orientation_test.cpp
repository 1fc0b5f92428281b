#include "common/exif_orientation.h"

#include <string>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

std::string number(uint32_t value, size_t size, bool big_endian) {
  std::string bytes;
  for (size_t i = 0; i < size; ++i) {
    const size_t shift = 8 * (big_endian ? size - 1 - i : i);
    bytes += static_cast<char>(value >> shift & 0xFFU);
  }
  return bytes;
}

/// A TIFF file with the tags ImageWidth (2 bytes) and Orientation.
std::string tiff_with(uint32_t orientation, bool big_endian, uint32_t type = 3) {
  const auto short_of = [&](uint32_t value) { return number(value, 2, big_endian); };
  const auto long_of = [&](uint32_t value) { return number(value, 4, big_endian); };
  const auto entry = [&](uint32_t tag, uint32_t of_type, uint32_t value) {
    return short_of(tag) + short_of(of_type) + long_of(1) + short_of(value) + short_of(0);
  };
  return (big_endian ? "MM" : "II") + short_of(42) + long_of(8) + short_of(2) +
         entry(0x0100, 3, 640) + entry(0x0112, type, orientation) + long_of(0);
}

std::string segment(uint8_t marker, const std::string& content) {
  return "\xFF" + std::string(1, static_cast<char>(marker)) +
         number(static_cast<uint32_t>(content.size() + 2), 2, true) + content;
}

std::string exif_segment(const std::string& tiff) {
  return segment(0xE1, std::string("Exif\0\0", 6) + tiff);
}

const std::string kStart = "\xFF\xD8";
const std::string kJfif = segment(0xE0, std::string("JFIF\0", 5) + std::string(9, '\1'));
const std::string kScan = segment(0xDA, "scan") + "pixels\xFF\xD9";

TEST(ExifOrientation, ReadsBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    for (int orientation = 1; orientation <= 8; ++orientation) {
      const std::string tiff = tiff_with(static_cast<uint32_t>(orientation), big_endian);
      EXPECT_EQ(exif_orientation(kStart + exif_segment(tiff) + kScan), orientation);
    }
  }
}

TEST(ExifOrientation, SkipsOtherSegmentsAndFillBytes) {
  const std::string xmp = segment(0xE1, "http://ns.adobe.com/xap/1.0/");
  const std::string exif = exif_segment(tiff_with(6, true));
  EXPECT_EQ(exif_orientation(kStart + kJfif + xmp + "\xFF\xFF" + exif + kScan), 6);
}

TEST(ExifOrientation, APictureWithoutTheTagHasNone) {
  EXPECT_FALSE(exif_orientation(""));
  EXPECT_FALSE(exif_orientation(kStart));
  EXPECT_FALSE(exif_orientation(kStart + kJfif + kScan));
  EXPECT_FALSE(exif_orientation(kStart + kScan + exif_segment(tiff_with(6, true))))
      << "after the start of the scan there are pixels";
  EXPECT_FALSE(exif_orientation(kStart + exif_segment("not TIFF") + kScan));
}

TEST(ExifOrientation, ValuesThatTheStandardDoesNotKnowAreNone) {
  for (const uint32_t value : {0U, 9U, 65535U}) {
    EXPECT_FALSE(exif_orientation(kStart + exif_segment(tiff_with(value, false)) + kScan));
  }
  EXPECT_FALSE(exif_orientation(kStart + exif_segment(tiff_with(6, false, 2)) + kScan));
}

TEST(ExifOrientation, ATruncatedFileIsReadWithinItsBounds) {
  for (const bool big_endian : {false, true}) {
    const std::string whole = kStart + exif_segment(tiff_with(3, big_endian));
    // The value ends 6 bytes before the end: two bytes fill its field, four end the directory.
    const size_t needed = whole.size() - 6;
    for (size_t size = 0; size <= whole.size(); ++size) {
      // A copy of its own, so that the address sanitizer sees the end.
      const std::string cut(whole, 0, size);
      EXPECT_EQ(exif_orientation(cut).has_value(), size >= needed) << size;
    }
  }
}

TEST(ExifOrientation, OffsetsAndLengthsBeyondTheEndAreNoError) {
  std::string tiff = tiff_with(3, true);
  tiff.replace(4, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_FALSE(exif_orientation(kStart + exif_segment(tiff) + kScan));
  tiff = tiff_with(3, true);
  tiff.replace(8, 2, "\xFF\xFF");
  EXPECT_EQ(exif_orientation(kStart + exif_segment(tiff) + kScan), 3);
  EXPECT_FALSE(exif_orientation(kStart + std::string("\xFF\xE1\0\1", 4) + tiff));
  EXPECT_FALSE(exif_orientation(kStart + "\xFF\xE0\xFF\xFF" + exif_segment(tiff)));
}

}  // namespace
}  // namespace bevloc
