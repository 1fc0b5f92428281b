// The USB descriptors of the lab's cameras (USB 2.0, chapter 9; USB Video Class 1.0, chapter 3).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace bevloc::hil {

using Bytes = std::vector<uint8_t>;

inline constexpr int kWidthPx = 640;
inline constexpr int kHeightPx = 360;
inline constexpr uint32_t kYuyvBytes = 2 * kWidthPx * kHeightPx;

/// Frame rates that a camera offers, in frames per second.
inline constexpr std::array<int, 4> kFrameRates{1, 2, 5, 10};

/// The frame interval in units of 100 ns, as in UVC.
constexpr uint32_t frame_interval(int frames_per_s) {
  return static_cast<uint32_t>(10'000'000 / frames_per_s);
}

/// bFormatIndex of the two formats.
enum class PixelFormat : uint8_t { kYuyv = 1, kMjpeg = 2 };

/// The bulk IN endpoint for frames.
inline constexpr uint8_t kStreamEndpoint = 0x81;
inline constexpr uint16_t kMaxPacketBytes = 512;
inline constexpr uint16_t kVendorId = 0x1209;   // pid.codes, for open-source devices
inline constexpr uint16_t kProductId = 0x0001;  // its product id for tests
inline constexpr uint8_t kControlInterface = 0;
inline constexpr uint8_t kStreamInterface = 1;

Bytes device_descriptor();
Bytes device_qualifier();
Bytes configuration_descriptor();

/// String `index` of camera `name`: 0 languages, 1 manufacturer, 2 product, 3 serial number;
/// otherwise empty. Product and serial number distinguish the cameras: udev makes the names in
/// /dev/v4l/by-id from them.
Bytes string_descriptor(int index, const std::string& name);

/// Append a number in little-endian order.
void append_u16(Bytes& bytes, uint32_t value);
void append_u32(Bytes& bytes, uint32_t value);

}  // namespace bevloc::hil
