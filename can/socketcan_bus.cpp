#include "can/socketcan_bus.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bevloc::can {
namespace {

using std::chrono::nanoseconds;

std::string reason(int error) {
  return std::generic_category().message(error);
}

nanoseconds since_zero(const timespec& time) {
  return std::chrono::seconds(time.tv_sec) + nanoseconds(time.tv_nsec);
}

nanoseconds read_clock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return since_zero(time);
}

template <typename T>
bool set_option(int descriptor, int level, int name, const T& value) {
  return setsockopt(descriptor, level, name, &value, sizeof(value)) == 0;
}

/// Standard data frames with these identifiers alone; filtered in the kernel.
bool set_filter(int descriptor, const std::vector<uint32_t>& ids) {
  if (ids.empty()) return true;
  std::vector<can_filter> filters;
  filters.reserve(ids.size());
  for (const uint32_t id : ids) {
    filters.push_back({.can_id = id, .can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  return setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                    static_cast<socklen_t>(filters.size() * sizeof(can_filter))) == 0;
}

/// Bus errors proper (CAN_ERR_BUSERROR) stay off: on a bad cable they flood the socket.
constexpr can_err_mask_t kReportedErrors = CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_TRX |
                                           CAN_ERR_ACK | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;

/// What the kernel says beside a frame.
struct Ancillary {
  std::optional<nanoseconds> realtime;
  std::optional<uint32_t> dropped_total;
};

Ancillary read_ancillary(msghdr& message) {
  Ancillary ancillary;
  for (cmsghdr* entry = CMSG_FIRSTHDR(&message); entry != nullptr;
       entry = CMSG_NXTHDR(&message, entry)) {
    if (entry->cmsg_level != SOL_SOCKET) continue;
    if (entry->cmsg_type == SCM_TIMESTAMPNS) {
      timespec time{};
      std::memcpy(&time, CMSG_DATA(entry), sizeof(time));
      ancillary.realtime = since_zero(time);
    } else if (entry->cmsg_type == SO_RXQ_OVFL) {
      uint32_t total = 0;
      std::memcpy(&total, CMSG_DATA(entry), sizeof(total));
      ancillary.dropped_total = total;
    }
  }
  return ancillary;
}

/// The kernel stamps in CLOCK_REALTIME, which can be set at any moment; the age of the stamp
/// carries it over to the steady clock. An age that cannot be (the clock was just set) counts as
/// none.
Time steady_time_of(const Ancillary& ancillary) {
  const nanoseconds now = read_clock(CLOCK_MONOTONIC);
  if (!ancillary.realtime) return Time(now);
  const nanoseconds age = read_clock(CLOCK_REALTIME) - *ancillary.realtime;
  const bool plausible = age >= nanoseconds::zero() && age <= std::chrono::seconds(10);
  return Time(plausible ? now - age : now);
}

std::optional<Frame> data_frame_from(const can_frame& raw, ssize_t size) {
  if (size != CAN_MTU || raw.can_dlc > CAN_MAX_DLEN) return std::nullopt;
  if ((raw.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG)) != 0) return std::nullopt;
  Frame frame{.id = raw.can_id & CAN_SFF_MASK, .length = raw.can_dlc};
  std::copy_n(raw.data, raw.can_dlc, frame.data.begin());
  return frame;
}

}  // namespace

Result<std::unique_ptr<SocketCanBus>> SocketCanBus::open(
    const std::string& interface, const std::vector<uint32_t>& accepted_ids) {
  const int descriptor = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor < 0) {
    return fail("{}: this kernel gives no CAN socket ({}), wanted one with CONFIG_CAN_RAW",
                interface, reason(errno));
  }
  std::unique_ptr<SocketCanBus> bus(new SocketCanBus(descriptor));

  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0) {
    return fail("{}: no such interface ({}), wanted a CAN interface as `ip link` lists them",
                interface, reason(errno));
  }
  const int on = 1;
  if (!set_filter(descriptor, accepted_ids) ||
      !set_option(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kReportedErrors) ||
      !set_option(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, on) ||
      !set_option(descriptor, SOL_SOCKET, SO_RXQ_OVFL, on)) {
    return fail("{}: the kernel refused a CAN socket option ({})", interface, reason(errno));
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return fail("{}: cannot bind ({}), wanted a CAN interface", interface, reason(errno));
  }
  return bus;
}

std::unique_ptr<SocketCanBus> SocketCanBus::from_descriptor(int descriptor) {
  return std::unique_ptr<SocketCanBus>(new SocketCanBus(descriptor));
}

SocketCanBus::~SocketCanBus() {
  close(descriptor_);
}

SendResult SocketCanBus::send(const Frame& frame, Time /*now*/) {
  assert(frame.id <= kMaxStandardId && frame.length <= kMaxFrameLength);
  can_frame raw{};
  raw.can_id = frame.id;
  raw.can_dlc = frame.length;
  std::copy_n(frame.data.begin(), frame.length, raw.data);
  // poll() says a CAN socket is writable even when the interface's queue (txqueuelen, 10 frames by
  // default) is full, so the answer of the send itself is the only one that counts.
  if (::send(descriptor_, &raw, sizeof(raw), MSG_DONTWAIT | MSG_NOSIGNAL) == CAN_MTU) {
    return counters_.count(SendResult::kSent);
  }
  const bool full = errno == ENOBUFS || errno == EAGAIN || errno == EINTR;
  return counters_.count(full ? SendResult::kDropped : SendResult::kBusDown);
}

std::optional<ReceivedFrame> SocketCanBus::receive() {
  for (;;) {
    can_frame raw{};
    iovec buffer{.iov_base = &raw, .iov_len = sizeof(raw)};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(uint32_t))];
    msghdr message{};
    message.msg_iov = &buffer;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof(control);
    const ssize_t size = recvmsg(descriptor_, &message, MSG_DONTWAIT | MSG_TRUNC);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return std::nullopt;

    const Ancillary ancillary = read_ancillary(message);
    if (ancillary.dropped_total) counters_.receive_dropped = *ancillary.dropped_total;
    if (size == CAN_MTU && (raw.can_id & CAN_ERR_FLAG) != 0) {
      ++counters_.error_frames;
      if ((raw.can_id & CAN_ERR_BUSOFF) != 0) ++counters_.bus_off;
      continue;
    }
    if (const auto frame = data_frame_from(raw, size)) {
      ++counters_.received;
      return ReceivedFrame{*frame, steady_time_of(ancillary)};
    }
    ++counters_.receive_ignored;
  }
}

bool SocketCanBus::wait(Duration timeout) {
  pollfd entry{.fd = descriptor_, .events = POLLIN, .revents = 0};
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  const timespec limit{.tv_sec = seconds.count(), .tv_nsec = (timeout - seconds).count()};
  return ppoll(&entry, 1, &limit, nullptr) > 0;
}

}  // namespace bevloc::can
