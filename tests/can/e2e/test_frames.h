// Frames with given bytes, and single bit errors, for the E2E tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "can/bus/frame.h"

namespace bevloc::test {

inline can::Frame frame_of(const std::vector<uint8_t>& bytes) {
  can::Frame frame{.id = 0x123, .length = static_cast<uint8_t>(bytes.size())};
  std::ranges::copy(bytes, frame.data.begin());
  return frame;
}

inline void flip(can::Frame& frame, int bit) {
  frame.data[bit / 8] ^= static_cast<uint8_t>(1u << (bit % 8));
}

}  // namespace bevloc::test
