// A CAN bus without hardware, inside the process.
#pragma once

#include <cstddef>
#include <memory>

#include "can/bus/bus.h"

namespace bevloc::can {

/// The wire that mock endpoints share. Every other endpoint receives a sent frame, stamped with the
/// sender's `now`, so that a virtual clock works. Frames never collide and take no time.
/// Thread-safe. An endpoint may outlive the MockWire that made it.
class MockWire {
 public:
  /// Each endpoint holds at most `queue_capacity` unread frames. On overflow it drops an older
  /// frame and counts the loss (ReceiveQueue).
  explicit MockWire(size_t queue_capacity = 256);

  /// Makes a new endpoint. It receives frames from now on and leaves the wire when it is destroyed.
  std::unique_ptr<Bus> connect();

  /// A wire that is down accepts no frame: send() returns kBusDown.
  void set_down(bool down);

  struct State;

 private:
  std::shared_ptr<State> state_;
  size_t queue_capacity_;
};

}  // namespace bevloc::can
