#include "drivers/gnss/gpsd_client.h"

#include <algorithm>
#include <cerrno>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

namespace bevloc::drivers {
namespace {

constexpr Duration kFirstPause = std::chrono::milliseconds(200);
constexpr Duration kLongestPause = std::chrono::seconds(5);

bool becomes_ready(int socket, short events, Duration timeout) {
  pollfd ready{.fd = socket, .events = events, .revents = 0};
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(timeout);
  return poll(&ready, socket < 0 ? 0 : 1, static_cast<int>(wait.count())) == 1;
}

/// Makes a socket that is being connected. Returns 0 or an errno.
int make_connecting(const GpsdAddress& address, FileDescriptor& made) {
  sockaddr_storage target{};
  socklen_t size = 0;
  auto& four = reinterpret_cast<sockaddr_in&>(target);
  auto& six = reinterpret_cast<sockaddr_in6&>(target);
  if (inet_pton(AF_INET, address.address.c_str(), &four.sin_addr) == 1) {
    four.sin_family = AF_INET;
    four.sin_port = htons(address.port);
    size = sizeof(four);
  } else if (inet_pton(AF_INET6, address.address.c_str(), &six.sin6_addr) == 1) {
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(address.port);
    size = sizeof(six);
  } else {
    return EINVAL;
  }
  made.reset(socket(target.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (made.get() < 0) return errno;
  if (::connect(made.get(), reinterpret_cast<const sockaddr*>(&target), size) == 0) return 0;
  return errno == EINPROGRESS ? 0 : errno;
}

/// Asks for reports on a socket that is connected. Returns 0 or an errno.
int ask_for_reports(int socket, const std::string& watch) {
  int error = 0;
  socklen_t size = sizeof(error);
  if (getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) != 0) return errno;
  if (error != 0) return error;
  const ssize_t sent = send(socket, watch.data(), watch.size(), MSG_NOSIGNAL);
  if (sent < 0) return errno;
  return sent == static_cast<ssize_t>(watch.size()) ? 0 : EMSGSIZE;
}

}  // namespace

std::string watch_command(const GpsdAddress& address) {
  const std::string device = address.device.empty() ? "" : ",\"device\":\"" + address.device + "\"";
  return "?WATCH={\"enable\":true,\"json\":true" + device + "};\n";
}

GpsdClient::GpsdClient(const GpsdAddress& address) : address_(address), pause_(kFirstPause) {}

void GpsdClient::wait(Time now, Duration timeout) {
  if (state_ == State::kClosed && now >= next_try_) begin_connecting(now);
  switch (state_) {
    case State::kClosed:
      becomes_ready(-1, 0, timeout);  // so that the caller's loop does not spin
      break;
    case State::kConnecting:
      finish_connecting(now, timeout);
      break;
    case State::kConnected:
      receive(now, timeout);
      break;
  }
}

void GpsdClient::begin_connecting(Time now) {
  const int error = make_connecting(address_, socket_);
  since_ = now;
  if (error == 0) {
    state_ = State::kConnecting;
  } else {
    note_failure(now, error);
  }
}

void GpsdClient::note_failure(Time now, int error) {
  ++counters_.failed;
  counters_.failure = error;
  close_socket(now);
}

void GpsdClient::finish_connecting(Time now, Duration timeout) {
  const bool ready = becomes_ready(socket_.get(), POLLOUT, timeout);
  if (!ready && now - since_ < kConnectPatience) return;
  const int error = ready ? ask_for_reports(socket_.get(), watch_command(address_)) : ETIMEDOUT;
  if (error == 0) {
    state_ = State::kConnected;
    since_ = now;
    ++counters_.connected;
  } else {
    note_failure(now, error);
  }
}

void GpsdClient::close_socket(Time now) {
  socket_.reset();
  state_ = State::kClosed;
  received_.clear();
  skips_line_ = false;
  next_try_ = now + pause_;
  pause_ = std::min(2 * pause_, kLongestPause);
}

void GpsdClient::receive(Time now, Duration timeout) {
  if (!becomes_ready(socket_.get(), POLLIN, timeout)) {
    if (now - since_ < kSilence) return;
    ++counters_.silent;
    close_socket(now);
    return;
  }
  std::array<char, 4096> bytes{};
  const ssize_t count = recv(socket_.get(), bytes.data(), bytes.size(), 0);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count <= 0) {
    close_socket(now);
    return;
  }
  since_ = now;
  pause_ = kFirstPause;
  received_.append(bytes.data(), static_cast<size_t>(count));
}

std::optional<GnssFix> GpsdClient::take_fix() {
  for (size_t end = received_.find('\n'); end != std::string::npos; end = received_.find('\n')) {
    const std::string line = received_.substr(0, end);
    received_.erase(0, end + 1);
    if (skips_line_) {
      skips_line_ = false;
      continue;
    }
    const GpsdReport report = reader_.read(line);
    ++counters_.lines[static_cast<size_t>(report.line)];
    if (report.line == GpsdLine::kFix) return report.fix;
  }
  if (skips_line_) {
    received_.clear();
  } else if (received_.size() > kLongestLine) {
    ++counters_.too_long;
    skips_line_ = true;
    received_.clear();
  }
  return std::nullopt;
}

}  // namespace bevloc::drivers
