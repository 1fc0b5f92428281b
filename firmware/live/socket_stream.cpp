#include "firmware/live/socket_stream.h"

#include <algorithm>
#include <cerrno>

#include <poll.h>
#include <sys/socket.h>

namespace bevloc::firmware {
namespace {

constexpr size_t kReceiveBytes = 4096;

using SteadyClock = std::chrono::steady_clock;

/// Waits until the socket is ready for `event`. Returns false if it is not ready at `until`.
bool wait_for(int socket, short event, SteadyClock::time_point until) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - SteadyClock::now());
  if (left.count() <= 0) return false;
  pollfd ready{socket, event, 0};
  return poll(&ready, 1, static_cast<int>(left.count())) > 0;
}

}  // namespace

SocketStream::SocketStream(const FileDescriptor& socket, const HttpLimits& limits)
    : socket_(socket), limits_(limits), read_until_(SteadyClock::now() + limits.request) {}

bool SocketStream::is_writable() const {
  return wait_for(socket_.get(), POLLOUT, SteadyClock::now() + limits_.write);
}

bool SocketStream::fill() {
  buffer_.resize(kReceiveBytes);
  next_ = 0;
  while (read_bytes_ < limits_.request_bytes) {
    const size_t most = std::min(kReceiveBytes, limits_.request_bytes - read_bytes_);
    const ssize_t received = recv(socket_.get(), buffer_.data(), most, 0);
    if (received > 0) {
      buffer_.resize(static_cast<size_t>(received));
      read_bytes_ += buffer_.size();
      return true;
    }
    const bool retry = received < 0 && (errno == EAGAIN || errno == EINTR);
    if (!retry || !wait_for(socket_.get(), POLLIN, read_until_)) break;
  }
  buffer_.clear();
  return false;
}

ssize_t SocketStream::read(char* text, size_t size) {
  if (next_ == buffer_.size() && !fill()) return -1;
  const size_t taken = std::min(size, buffer_.size() - next_);
  std::copy_n(buffer_.data() + next_, taken, text);
  next_ += taken;
  return static_cast<ssize_t>(taken);
}

/// Writes a part of the text, as write(2) does.
ssize_t SocketStream::write(const char* text, size_t size) {
  while (true) {
    const ssize_t sent = send(socket_.get(), text, size, MSG_NOSIGNAL);
    if (sent >= 0) return sent;
    if (errno != EAGAIN && errno != EINTR) return -1;
    if (!is_writable()) return -1;
  }
}

void SocketStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

void SocketStream::get_local_ip_and_port(std::string& ip, int& port) const {
  ip.clear();
  port = 0;
}

}  // namespace bevloc::firmware
