#include "tests/can/bus/bus_under_test.h"

#include <cstdlib>
#include <utility>

#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "can/bus/mock_bus.h"
#include "can/bus/socketcan_bus.h"

namespace bevloc::can {
namespace {

BusPair connect_mock() {
  const auto wire = std::make_shared<MockWire>();
  return {wire->connect(), wire->connect(), true, [wire](bool up) {
            wire->set_down(!up);
            return true;
          }};
}

/// The SocketCAN code on a socket pair, for machines whose kernel has no CAN.
BusPair connect_socket_pair() {
  int descriptors[2];
  if (socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, descriptors) != 0)
    return {};
  return {SocketCanBus::from_descriptor(descriptors[0]),
          SocketCanBus::from_descriptor(descriptors[1]),
          true,
          {}};
}

/// Does the same as `ip link set NAME up`. Needs CAP_NET_ADMIN.
bool set_interface_up(const std::string& name, bool up) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  name.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
  bool done = ioctl(descriptor, SIOCGIFFLAGS, &request) == 0;
  const int flags = up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP;
  request.ifr_flags = static_cast<short>(flags);
  done = done && ioctl(descriptor, SIOCSIFFLAGS, &request) == 0;
  close(descriptor);
  return done;
}

/// The name of the interface that the user wants to test, or null.
const char* chosen_interface() {
  return std::getenv("BEVLOC_TEST_CAN");
}

BusPair connect_kernel() {
  const std::string interface = kernel_interface();
  BusPair none;
  for (const bool fd : {true, false}) {
    const SocketCanOptions options{.fd = fd};
    auto a = SocketCanBus::open(interface, options);
    auto b = SocketCanBus::open(interface, options);
    if (a && b) {
      return {std::move(*a), std::move(*b), fd,
              [interface](bool up) { return set_interface_up(interface, up); }};
    }
    if (chosen_interface() != nullptr) none.refusal = (a ? b : a).error().message;
  }
  return none;
}

}  // namespace

std::string kernel_interface() {
  return chosen_interface() != nullptr ? chosen_interface() : "vcan0";
}

std::vector<BusImplementation> buses_under_test() {
  return {{"Mock", connect_mock},
          {"SocketCanOnSocketPair", connect_socket_pair},
          {"SocketCan", connect_kernel}};
}

}  // namespace bevloc::can
