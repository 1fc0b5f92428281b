// A raw CAN socket that finds its interface again after a loss.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <linux/can.h>

#include "can/bus/back_off.h"
#include "common/file_descriptor.h"
#include "common/result.h"

namespace bevloc::can {

struct SocketCanOptions {
  /// Standard identifiers that the kernel passes to this socket. If this is empty, it passes all.
  std::vector<uint32_t> accepted_ids{};
  /// Identifiers of the frames that this endpoint sends and confirms by their echo (SendGate). If
  /// this is empty, nothing is confirmed. Frames of other nodes with these identifiers also pass
  /// the filter.
  std::vector<uint32_t> confirmed_ids{};
  /// Identifiers that no other node may use. They also pass the filter, so that a frame of another
  /// node is noticed.
  std::vector<uint32_t> reserved_ids{};
  /// Whether open() refuses a classic interface, because FD frames are to be sent. FD frames are
  /// always received.
  bool fd = false;
  /// A frame that waits for room longer than this is dropped. The default is two cycles of the
  /// solution.
  Duration max_send_age = std::chrono::milliseconds(20);
};

/// An interface that was down is used again as soon as it is up. An interface that disappeared (an
/// unplugged adapter) is looked for by its name, and the same socket is bound to it again.
/// Thread-safe after open().
class SocketCanLink {
 public:
  /// Fails when the kernel has no CAN support or no interface of this name, or when CAN FD is
  /// wanted and the interface is not set up for it.
  static Result<std::unique_ptr<SocketCanLink>> open(const std::string& interface,
                                                     const SocketCanOptions& options);

  /// Takes ownership of a descriptor without an interface. repair() does nothing for it.
  explicit SocketCanLink(int descriptor) : descriptor_(descriptor) {}

  int descriptor() const { return descriptor_.get(); }

  /// Records the result of a system call on the socket: 0 or an errno.
  void note(int error);
  bool is_down() const { return error_ != 0; }

  /// Whether CAN FD is wanted, and the interface came back as a classic one.
  bool lacks_fd() const { return lacks_fd_ && !lost_; }

  /// Whether a frame of this socket waits in the kernel's queue for room in the controller. A frame
  /// that the controller has does not count.
  bool has_queued_frames() const;

  /// Whether the controller is bus-off. Also true of one end of a vxcan pair while the other end is
  /// down.
  bool is_bus_off() const;

  /// Looks for a lost interface if the next attempt is due (BackOff). Returns true when the
  /// interface was found and bound. Notices that an interface that was down is up again.
  bool repair();

 private:
  bool bind_by_name();
  bool is_up() const;
  void look_at_fd();

  const FileDescriptor descriptor_;
  std::string interface_;
  std::vector<can_filter> filters_;
  bool wants_fd_ = false;
  std::atomic<int> error_{0};  ///< what note() recorded
  std::atomic<bool> lost_{false};
  std::atomic<bool> lacks_fd_{false};
  std::atomic_flag repairing_;
  BackOff back_off_{std::chrono::milliseconds(20), std::chrono::milliseconds(320)};
};

}  // namespace bevloc::can
