// An error report of a CAN controller, in the form in which the Linux kernel delivers it.
#pragma once

#include <array>
#include <cstdint>

#include "can/bus/frame.h"

namespace bevloc::can {

struct ErrorFrame {
  uint32_t classes = 0;  ///< CAN_ERR_* bits of linux/can/error.h, without CAN_ERR_FLAG
  std::array<uint8_t, kMaxClassicLength> data{};

  bool operator==(const ErrorFrame&) const = default;
};

}  // namespace bevloc::can
