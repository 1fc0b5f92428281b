// What the kernel reads from and writes to a raw CAN socket (Documentation/networking/can.rst).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include <linux/can.h>
#include <sys/socket.h>

#include "can/error_frame.h"
#include "can/frame.h"
#include "can/receive_clock.h"

namespace bevloc::can {

/// The kernel's form of a frame. `struct can_frame` is the beginning of `struct canfd_frame`.
struct RawFrame {
  canfd_frame content{};
  size_t size = 0;  ///< CAN_MTU or CANFD_MTU
};
RawFrame raw_from(const Frame& frame);

/// std::monostate: extended, remote or malformed.
using ReadFrame = std::variant<std::monostate, Frame, ErrorFrame>;
ReadFrame frame_from(const canfd_frame& content, size_t size);

/// What the kernel says beside a frame.
struct Ancillary {
  KernelStamps stamps;
  std::optional<uint32_t> dropped_total;  ///< by the socket since it was opened, modulo 2^32
};
/// Room for all of it.
constexpr size_t kAncillarySize =
    CMSG_SPACE(3 * sizeof(timespec)) + CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(uint32_t));
Ancillary ancillary_from(msghdr& message);

/// The frame is the echo of one that this socket sent.
inline bool is_own_echo(const msghdr& message) {
  return (message.msg_flags & MSG_CONFIRM) != 0;
}

}  // namespace bevloc::can
