// An error report of a CAN controller, as the Linux kernel puts it into a frame.
#pragma once

#include <array>
#include <cstdint>

#include "can/frame.h"

namespace bevloc::can {

struct ErrorFrame {
  uint32_t classes = 0;  ///< CAN_ERR_* bits of linux/can/error.h, without CAN_ERR_FLAG
  std::array<uint8_t, kMaxClassicLength> data{};

  bool operator==(const ErrorFrame&) const = default;
};

}  // namespace bevloc::can
