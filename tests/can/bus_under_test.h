// The buses that the conformance suite runs on.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "can/bus.h"

namespace bevloc::can {

/// Two endpoints on one bus.
struct BusPair {
  std::unique_ptr<Bus> a;
  std::unique_ptr<Bus> b;
  bool carries_fd = false;
  /// Takes the bus down or up; false where this process may not. Empty where there is no such
  /// thing.
  std::function<bool(bool up)> set_up;
};

struct BusImplementation {
  std::string name;
  /// A pair, or an empty one where this machine cannot have it.
  std::function<BusPair()> connect;
};

/// The mock, SocketCAN on a socket pair, and SocketCAN on the interface of the kernel that the
/// environment names by BEVLOC_TEST_CAN (vcan0 if it names none).
std::vector<BusImplementation> buses_under_test();

/// The name of that interface.
std::string kernel_interface();

}  // namespace bevloc::can
