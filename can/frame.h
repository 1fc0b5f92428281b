// A classic CAN data frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/time.h"

namespace bevloc::can {

constexpr uint32_t kMaxStandardId = 0x7FF;
constexpr size_t kMaxFrameLength = 8;

/// A data frame with an 11-bit identifier and up to 8 bytes (ISO 11898-1, classic base format).
struct Frame {
  uint32_t id = 0;
  uint8_t length = 0;
  std::array<uint8_t, kMaxFrameLength> data{};

  std::span<const uint8_t> payload() const { return {data.data(), length}; }
  bool operator==(const Frame&) const = default;
};

struct ReceivedFrame {
  Frame frame;
  Time received{};
};

}  // namespace bevloc::can
