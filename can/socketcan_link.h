// A raw CAN socket and the interface that it is bound to.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <linux/can.h>

#include "can/back_off.h"
#include "common/result.h"

namespace bevloc::can {

struct SocketCanOptions {
  /// Standard identifiers that the kernel lets through; none means all.
  std::vector<uint32_t> accepted_ids{};
  /// Identifiers that this endpoint sends and whose way to the wire it follows by their echo
  /// (SendGate); none means that it does not. Others' frames with these identifiers come through.
  std::vector<uint32_t> confirmed_ids{};
  bool fd = false;  ///< also send and receive FD frames
  /// What waited for room longer than this is not sent: two cycles of the solution.
  Duration max_send_age = std::chrono::milliseconds(20);
};

/// An interface that was down is used again as soon as it is up; one that was gone (an adapter
/// unplugged) is looked for by its name and the same socket is bound to it again.
class SocketCanLink {
 public:
  /// Fails when the kernel has no CAN, no interface of that name, or one without FD where wanted.
  static Result<std::unique_ptr<SocketCanLink>> open(const std::string& interface,
                                                     const SocketCanOptions& options);

  /// A descriptor that is no socket of an interface; it is not looked for when lost.
  explicit SocketCanLink(int descriptor) : descriptor_(descriptor) {}

  ~SocketCanLink();
  SocketCanLink(const SocketCanLink&) = delete;
  SocketCanLink& operator=(const SocketCanLink&) = delete;

  int descriptor() const { return descriptor_; }

  /// What the kernel answered to a call. `error` 0: it worked.
  void note(int error);
  bool is_down() const { return down_; }

  /// Looks for a lost interface if it is time to; true when it was found and bound. For any thread.
  bool repair();

 private:
  bool bind_by_name();

  const int descriptor_;
  std::string interface_;
  std::vector<can_filter> filters_;
  std::atomic<bool> down_{false};
  std::atomic<bool> lost_{false};
  std::atomic_flag repairing_;
  BackOff back_off_{std::chrono::milliseconds(20), std::chrono::milliseconds(320)};
};

}  // namespace bevloc::can
