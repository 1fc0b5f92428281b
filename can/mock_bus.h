// A CAN bus inside the process.
#pragma once

#include <cstddef>
#include <memory>

#include "can/bus.h"

namespace bevloc::can {

/// The wire that mock endpoints share. What one sends, every other one sees at the time that the
/// sender gave, so that a virtual clock works. Frames never collide and take no time.
/// An endpoint may outlive the MockWire object it came from.
class MockWire {
 public:
  /// Each endpoint holds at most `queue_capacity` unread frames; on overflow the newest of each
  /// identifier wins and the loss is counted (FrameQueue).
  explicit MockWire(size_t queue_capacity = 256);

  /// A new endpoint; it sees what is sent from now on and leaves the wire when destroyed.
  std::unique_ptr<Bus> connect();

  /// A wire that is down takes no frame: send() says kBusDown.
  void set_down(bool down);

  struct State;

 private:
  std::shared_ptr<State> state_;
  size_t queue_capacity_;
};

}  // namespace bevloc::can
