// Converts frames from and to the kernel's format on a raw CAN socket
// (Documentation/networking/can.rst).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include <linux/can.h>
#include <sys/socket.h>

#include "can/bus/error_frame.h"
#include "can/bus/frame.h"
#include "can/bus/receive_clock.h"

namespace bevloc::can {

/// A frame in the kernel's format. `struct can_frame` is the beginning of `struct canfd_frame`.
struct RawFrame {
  canfd_frame content{};
  size_t size = 0;  ///< CAN_MTU or CANFD_MTU
};
RawFrame raw_from(const Frame& frame);

/// A data frame or an error report. std::monostate stands for an extended, remote or malformed
/// frame.
using ReadFrame = std::variant<std::monostate, Frame, ErrorFrame>;
ReadFrame frame_from(const canfd_frame& content, size_t size);

/// The ancillary data (cmsg) that the kernel delivers with a frame.
struct Ancillary {
  KernelStamps stamps;
  /// Number of frames that the socket has dropped since it was opened, modulo 2^32.
  std::optional<uint32_t> dropped_total;
};
/// Bytes of the buffer that holds all ancillary data of one frame.
constexpr size_t kAncillarySize =
    CMSG_SPACE(3 * sizeof(timespec)) + CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(uint32_t));
Ancillary ancillary_from(msghdr& message);

/// Whether the frame is the echo of a frame that this socket sent.
inline bool is_own_echo(const msghdr& message) {
  return (message.msg_flags & MSG_CONFIRM) != 0;
}

}  // namespace bevloc::can
