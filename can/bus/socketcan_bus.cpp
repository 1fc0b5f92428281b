#include "can/bus/socketcan_bus.h"

#include <cassert>
#include <cerrno>
#include <utility>

#include <linux/can/error.h>
#include <poll.h>
#include <sys/socket.h>

#include "common/kernel_time.h"

namespace bevloc::can {
namespace {

/// More than the number of identifiers that any program sends.
constexpr size_t kSendQueueCapacity = 32;

bool is_no_room(int error) {
  return error == ENOBUFS || error == EAGAIN || error == EINTR;
}

}  // namespace

Result<std::unique_ptr<SocketCanBus>> SocketCanBus::open(const std::string& interface,
                                                         const SocketCanOptions& options) {
  auto link = SocketCanLink::open(interface, options);
  if (!link) return tl::unexpected(link.error());
  std::unique_ptr<SocketCanBus> bus(new SocketCanBus(std::move(*link), options));
  // Drivers report only the change to bus-off.
  if (bus->link_->is_bus_off()) bus->monitor_.note_bus_off();
  return bus;
}

std::unique_ptr<SocketCanBus> SocketCanBus::from_descriptor(int descriptor,
                                                            const SocketCanOptions& options) {
  return std::unique_ptr<SocketCanBus>(
      new SocketCanBus(std::make_unique<SocketCanLink>(descriptor), options));
}

SocketCanBus::SocketCanBus(std::unique_ptr<SocketCanLink> link, const SocketCanOptions& options)
    : link_(std::move(link)),
      max_send_age_(options.max_send_age),
      queue_(kSendQueueCapacity),
      gate_(options.confirmed_ids) {}

SendResult SocketCanBus::send(const Frame& frame, Time now) {
  assert(frame.id <= kMaxStandardId && is_valid_length(frame.format, frame.length));
  repair();
  if (!queue_.push(frame, now)) ++counters_.send_replaced;
  counters_.send_expired += queue_.drop_older_than(now - max_send_age_);
  queue_.offer([this](const Frame& next) { return write(next); });
  if (link_->is_down()) {
    note_down();
    counters_.send_bus_down += queue_.size();
    queue_.clear();
  }
  counters_.send_waiting = queue_.size();
  if (link_->is_down()) return SendResult::kBusDown;
  return queue_.holds(frame.id) ? SendResult::kWaiting : SendResult::kSent;
}

SendQueue::Answer SocketCanBus::write(const Frame& frame) {
  if (!gate_.enter(frame.id, steady_now())) return SendQueue::Answer::kLater;
  const RawFrame raw = raw_from(frame);
  // poll() reports a CAN socket as writable even when the interface's queue (txqueuelen, 10 frames
  // by default) is full. Only send() itself shows whether there is room.
  const ssize_t written =
      ::send(link_->descriptor(), &raw.content, raw.size, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (written == static_cast<ssize_t>(raw.size)) {
    link_->note(0);
    ++counters_.sent;
    return SendQueue::Answer::kTaken;
  }
  const int error = errno;
  gate_.leave(frame.id);
  link_->note(is_no_room(error) ? 0 : error);
  return SendQueue::Answer::kNoRoom;
}

std::optional<ReceivedFrame> SocketCanBus::receive() {
  for (;;) {
    canfd_frame content{};
    iovec buffer{.iov_base = &content, .iov_len = sizeof(content)};
    alignas(cmsghdr) char control[kAncillarySize];
    msghdr message{};
    message.msg_iov = &buffer;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof(control);
    const ssize_t size = recvmsg(link_->descriptor(), &message, MSG_DONTWAIT | MSG_TRUNC);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && !is_no_room(errno)) {
      link_->note(errno);
      // The interface may be up again before the next send(), which then does not see the failure.
      note_down();
    }
    if (size <= 0) return std::nullopt;

    const Ancillary ancillary = ancillary_from(message);
    if (ancillary.dropped_total) counters_.receive_dropped = *ancillary.dropped_total;
    const ReadFrame read = frame_from(content, static_cast<size_t>(size));
    if (const auto* error = std::get_if<ErrorFrame>(&read)) {
      take_error(*error);
    } else if (const auto* frame = std::get_if<Frame>(&read)) {
      const bool is_echo = is_own_echo(message);
      note_traffic(*frame, is_echo);
      if (!is_echo) return stamped(*frame, ancillary);
    } else {
      ++counters_.receive_ignored;
    }
  }
}

ReceivedFrame SocketCanBus::stamped(const Frame& frame, const Ancillary& ancillary) {
  const auto stamp = clock_.to_steady(ancillary.stamps, {steady_now(), read_clock(CLOCK_REALTIME)});
  ++counters_.received;
  if (stamp.source == StampSource::kHardware) ++counters_.hardware_stamped;
  if (stamp.source == StampSource::kSoftware) ++counters_.software_stamped;
  return {frame, stamp.time};
}

void SocketCanBus::take_error(const ErrorFrame& error) {
  ++counters_.error_frames;
  if ((error.classes & CAN_ERR_BUSOFF) != 0) ++counters_.bus_off;
  if (says_frames_lost(error)) ++counters_.receive_overrun;
  monitor_.take(error);
  constexpr uint32_t kDiscarded = CAN_ERR_RESTARTED | CAN_ERR_TX_TIMEOUT;
  has_discarded_ = has_discarded_ || (error.classes & kDiscarded) != 0;
  free_places_of_discarded();
}

/// A frame that the controller has discarded gets no echo. But the frames in the kernel's queue are
/// still sent. New ones may follow only when it is empty. Otherwise, each restart would add old
/// frames to the queue.
void SocketCanBus::free_places_of_discarded() {
  if (!has_discarded_ || link_->has_queued_frames()) return;
  gate_.reset();
  has_discarded_ = false;
}

/// An interface that is down has no frames to send, and its controller starts anew.
void SocketCanBus::note_down() {
  gate_.reset();
  monitor_.reset();
}

void SocketCanBus::note_traffic(const Frame& frame, bool is_echo) {
  const Time now = steady_now();
  if (monitor_.note_traffic()) has_discarded_ = true;
  if (!is_echo) {
    gate_.note_alive(now);
  } else if (const auto latency = gate_.confirm(frame.id, now)) {
    counters_.count_confirmation(*latency);
  }
  free_places_of_discarded();
}

bool SocketCanBus::wait(Duration timeout) {
  repair();
  pollfd entry{.fd = link_->descriptor(), .events = POLLIN, .revents = 0};
  const timespec limit = timespec_of(timeout);
  return ppoll(&entry, 1, &limit, nullptr) > 0;
}

void SocketCanBus::repair() {
  if (link_->repair()) ++counters_.reopened;
}

BusCondition SocketCanBus::condition() const {
  BusCondition condition = monitor_.condition();
  if (link_->is_down()) condition.state = BusState::kDown;
  if (link_->lacks_fd()) condition.add(BusFault::kNoFd);
  return condition;
}

}  // namespace bevloc::can
