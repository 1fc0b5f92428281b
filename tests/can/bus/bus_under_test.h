// The CAN buses on which the conformance suite runs.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "can/bus/bus.h"

namespace bevloc::can {

/// Two endpoints on one bus.
struct BusPair {
  std::unique_ptr<Bus> a;
  std::unique_ptr<Bus> b;
  bool carries_fd = false;
  /// Takes the bus down or up; false when the process lacks the permission. Empty if the bus cannot
  /// be taken down.
  std::function<bool(bool up)> set_up;
  /// Why the interface that BEVLOC_TEST_CAN names cannot be tested. Empty if there is a pair, or if
  /// nobody named an interface.
  std::string refusal{};
};

struct BusImplementation {
  std::string name;
  /// Makes a pair; an empty one if this bus is not available on this machine.
  std::function<BusPair()> connect;
};

/// Returns the mock, SocketCAN on a socket pair, and SocketCAN on kernel_interface().
std::vector<BusImplementation> buses_under_test();

/// Returns the name of the CAN interface for the tests: the environment variable BEVLOC_TEST_CAN,
/// or vcan0.
std::string kernel_interface();

}  // namespace bevloc::can
