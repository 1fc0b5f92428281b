// A CAN data frame, classic or FD.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/time.h"

namespace bevloc::can {

constexpr uint32_t kMaxStandardId = 0x7FF;
constexpr size_t kMaxClassicLength = 8;
constexpr size_t kMaxFdLength = 64;

enum class FrameFormat : uint8_t {
  kClassic,  ///< up to 8 bytes (ISO 11898-1, classic base format)
  kFd,       ///< up to 64 bytes, data at the higher bit rate (FD base format with BRS)
};

/// A data frame with an 11-bit identifier. Bytes beyond `length` are 0.
struct Frame {
  uint32_t id = 0;
  uint8_t length = 0;
  std::array<uint8_t, kMaxFdLength> data{};
  FrameFormat format = FrameFormat::kClassic;

  std::span<const uint8_t> payload() const { return {data.data(), length}; }
  bool operator==(const Frame&) const = default;
};

/// Whether a frame of this format can have `length` bytes: 0 to 8, and on FD some lengths up to 64.
constexpr bool is_valid_length(FrameFormat format, size_t length) {
  constexpr std::array<size_t, 7> kLongLengths = {12, 16, 20, 24, 32, 48, 64};
  return length <= kMaxClassicLength ||
         (format == FrameFormat::kFd &&
          std::ranges::find(kLongLengths, length) != kLongLengths.end());
}

struct ReceivedFrame {
  Frame frame;
  Time received{};
};

}  // namespace bevloc::can
