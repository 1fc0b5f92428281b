#include "can/bus/socketcan_link.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <set>
#include <system_error>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "common/files.h"
#include "common/kernel_time.h"

namespace bevloc::can {
namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

template <typename T>
bool set_option(int descriptor, int level, int name, const T& value) {
  return setsockopt(descriptor, level, name, &value, sizeof(value)) == 0;
}

/// Filters that pass only standard data frames with these identifiers. The echo of an own frame has
/// to pass too.
std::vector<can_filter> filters_of(const SocketCanOptions& options) {
  if (options.accepted_ids.empty()) return {{.can_id = 0, .can_mask = 0}};
  std::set<uint32_t> passed;
  for (const auto* ids : {&options.accepted_ids, &options.confirmed_ids, &options.reserved_ids}) {
    passed.insert(ids->begin(), ids->end());
  }
  std::vector<can_filter> filters;
  for (const uint32_t id : passed) {
    filters.push_back({.can_id = id, .can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  return filters;
}

/// CAN_ERR_BUSERROR is not among them, because these reports flood the socket when a cable is bad.
constexpr can_err_mask_t kReportedErrors = CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_TRX |
                                           CAN_ERR_ACK | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;

/// Requests hardware stamps, where the controller has them, and software stamps. Older kernels have
/// software stamps only.
bool request_stamps(int descriptor) {
  const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE |
                     SOF_TIMESTAMPING_RX_HARDWARE | SOF_TIMESTAMPING_RAW_HARDWARE;
  return set_option(descriptor, SOL_SOCKET, SO_TIMESTAMPING, stamps) ||
         set_option(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, 1);
}

/// Makes the buffer as large as the kernel allows, so that a burst of frames is not lost.
void enlarge_receive_buffer(int descriptor) {
  constexpr int kBytes = 1 << 20;
  if (set_option(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, kBytes)) return;
  set_option(descriptor, SOL_SOCKET, SO_RCVBUF, kBytes);
}

/// The socket always receives FD frames, because a vehicle may send them beside classic frames,
/// even for 8 bytes or fewer. A classic interface carries none.
bool set_options(int descriptor, const SocketCanOptions& options) {
  const int on = 1;
  enlarge_receive_buffer(descriptor);
  return set_option(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kReportedErrors) &&
         set_option(descriptor, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on) &&
         (options.confirmed_ids.empty() ||
          set_option(descriptor, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, on)) &&
         request_stamps(descriptor) && set_option(descriptor, SOL_SOCKET, SO_RXQ_OVFL, on);
}

bool is_gone(int error) {
  return error == ENODEV || error == ENXIO;
}

ifreq request_for(const std::string& interface) {
  ifreq request{};
  interface.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
  return request;
}

/// Whether the interface exists and carries no CAN FD.
bool is_classic(int descriptor, const std::string& interface) {
  ifreq request = request_for(interface);
  return ioctl(descriptor, SIOCGIFMTU, &request) == 0 && request.ifr_mtu < int{CANFD_MTU};
}

}  // namespace

Result<std::unique_ptr<SocketCanLink>> SocketCanLink::open(const std::string& interface,
                                                           const SocketCanOptions& options) {
  const int descriptor = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor < 0) {
    return fail("{}: found a kernel without CAN sockets ({}), wanted one with CONFIG_CAN_RAW",
                interface, reason(errno));
  }
  auto link = std::make_unique<SocketCanLink>(descriptor);
  link->interface_ = interface;
  link->filters_ = filters_of(options);
  link->wants_fd_ = options.fd;
  if (if_nametoindex(interface.c_str()) == 0) {
    return fail("{}: found no such interface ({}), wanted a CAN interface that `ip link` lists",
                interface, reason(errno));
  }
  if (options.fd && is_classic(descriptor, interface)) {
    return fail(
        "{}: found a classic CAN interface, wanted one set up for CAN FD (`ip link set {} type can "
        "... fd on`)",
        interface, interface);
  }
  if (!set_options(descriptor, options)) {
    return fail(
        "{}: the kernel refused an option of CAN sockets ({}), wanted that of Debian 12 or newer",
        interface, reason(errno));
  }
  if (!link->bind_by_name()) {
    return fail("{}: the socket cannot be bound to this interface ({}), wanted a CAN interface",
                interface, reason(errno));
  }
  return link;
}

void SocketCanLink::note(int error) {
  if (is_gone(error)) lost_ = true;
  error_ = error;
}

/// The kernel charges a frame to its socket until a driver hands it to the controller. The copy
/// that the driver keeps for the echo is not charged.
bool SocketCanLink::has_queued_frames() const {
  std::array<uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof(memory);
  return getsockopt(descriptor(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 &&
         memory[SK_MEMINFO_WMEM_ALLOC] != 0;
}

/// A driver takes the carrier away when its controller goes bus-off. While the interface is down,
/// the file cannot be read.
bool SocketCanLink::is_bus_off() const {
  const auto carrier = read_file("/sys/class/net/" + interface_ + "/carrier");
  return carrier && carrier->starts_with('0');
}

bool SocketCanLink::repair() {
  if (interface_.empty()) return false;
  const int error = error_;
  if (!lost_ && error != 0) look_at_fd();
  // Without this check, an endpoint that only listens would never notice that the interface is up
  // again.
  if (!lost_ && (error == ENETDOWN || is_gone(error)) && is_up()) error_ = 0;
  if (!lost_ || repairing_.test_and_set()) return false;
  bool repaired = false;
  const Time now = steady_now();
  if (lost_ && back_off_.is_due(now)) {
    repaired = bind_by_name();
    if (repaired) {
      back_off_.reset();
      lost_ = false;
      look_at_fd();
    } else {
      back_off_.note_failure(now);
    }
  }
  repairing_.clear();
  return repaired;
}

/// An interface can change between classic CAN and CAN FD only while it is down or gone. Frames
/// that are too long for it are refused with EINVAL or EMSGSIZE.
void SocketCanLink::look_at_fd() {
  lacks_fd_ = wants_fd_ && is_classic(descriptor(), interface_);
}

bool SocketCanLink::is_up() const {
  ifreq request = request_for(interface_);
  return ioctl(descriptor(), SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

/// Sets the filters too, because the kernel discards them when the interface disappears.
bool SocketCanLink::bind_by_name() {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface_.c_str()));
  // Index 0 would bind the socket to all interfaces.
  return address.can_ifindex != 0 &&
         setsockopt(descriptor(), SOL_CAN_RAW, CAN_RAW_FILTER, filters_.data(),
                    static_cast<socklen_t>(filters_.size() * sizeof(can_filter))) == 0 &&
         bind(descriptor(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
}

}  // namespace bevloc::can
