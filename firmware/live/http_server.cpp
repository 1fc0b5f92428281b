#include "firmware/live/http_server.h"

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

#include <netdb.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include "firmware/config/live_config.h"
#include "firmware/live/socket_stream.h"
#include "firmware/threads/realtime.h"

namespace bevloc::firmware {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

constexpr int kBacklog = 128;
/// The send buffer of a connection. Without this limit the kernel buffers up to 4 MB, and a slow
/// link needs a minute to send them.
constexpr int kSendBuffer_bytes = 128 << 10;

httplib::Server::HandlerResponse refuse(httplib::Response& response, int status, const char* text) {
  response.status = status;
  response.set_content(text, "text/plain");
  return httplib::Server::HandlerResponse::Handled;
}

/// Whether a Host header names this machine by address or as "localhost".
bool is_local_host_header(const std::string& host) {
  std::string name = host.substr(0, host.find(':'));
  if (host.starts_with('[')) {
    const size_t end = host.find(']');
    if (end == std::string::npos) return false;
    name = host.substr(1, end - 1);
  }
  return name == "localhost" || is_ip_address(name);
}

httplib::Server::HandlerResponse look_at_request(const httplib::Request& request,
                                                 httplib::Response& response) {
  if (request.method != "GET" && request.method != "HEAD") {
    return refuse(response, 405, "only GET and HEAD\n");
  }
  if (request.get_header_value_count("Host") != 1 ||
      !is_local_host_header(request.get_header_value("Host"))) {
    return refuse(response, 403, "address this server by its IP address or as localhost\n");
  }
  return httplib::Server::HandlerResponse::Unhandled;
}

Result<FileDescriptor> listen_at(const std::string& address, int port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found);
      code != 0) {
    return fail("live: {}: found no IP address ({}), wanted one such as 127.0.0.1", address,
                gai_strerror(code));
  }
  FileDescriptor socket(::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  const bool bound = socket.get() >= 0 &&
                     bind(socket.get(), found->ai_addr, found->ai_addrlen) == 0 &&
                     listen(socket.get(), kBacklog) == 0;
  const int error = errno;
  freeaddrinfo(found);
  if (bound) return socket;
  return fail("live: found no way to listen at {} port {} ({}), wanted a free port of this machine",
              address, port, std::strerror(error));
}

int port_of(const FileDescriptor& socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  std::array<char, NI_MAXSERV> port{};
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  getnameinfo(reinterpret_cast<sockaddr*>(&address), size, nullptr, 0, port.data(), port.size(),
              NI_NUMERICSERV);
  return std::atoi(port.data());
}

}  // namespace

/// Uses cpp-httplib's parser, routes and responses, but not its sockets and threads.
class HttpServer::Responder final : public httplib::Server {
 public:
  /// Sets a dummy socket. Without one, cpp-httplib believes that the server has stopped, and ends
  /// every stream.
  Responder() { svr_sock_ = 0; }

  void answer(httplib::Stream& stream) { answer_by(*this, stream); }

 private:
  /// In Debian 13, process_request() of cpp-httplib also takes the addresses of both ends. No
  /// handler of ours reads them.
  template <typename Server>
  static void answer_by(Server& server, httplib::Stream& stream) {
    bool closed = false;
    // A request of 8 KiB can name thousands of ranges, and the response would repeat the whole
    // answer for each.
    const auto forget_ranges = [](httplib::Request& request) { request.ranges.clear(); };
    if constexpr (requires { server.process_request(stream, true, closed, forget_ranges); }) {
      server.process_request(stream, true, closed, forget_ranges);
    } else {
      server.process_request(stream, "", 0, "", 0, true, closed, forget_ranges);
    }
  }
};

class HttpServer::Impl {
 public:
  Impl(FileDescriptor listener, const HttpLimits& limits)
      : limits_(limits),
        listener_(std::move(listener)),
        wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        port_(port_of(listener_)) {
    responder_.set_pre_routing_handler(look_at_request);
  }
  ~Impl() { stop(); }

  Responder& responder() { return responder_; }
  int port() const { return port_; }

  void start() {
    threads_.emplace_back([this] {
      begin_low_thread("live-accept");
      while (!stopping_) accept_and_wait();
    });
    for (size_t i = 0; i < limits_.workers; ++i) {
      threads_.emplace_back([this] {
        begin_low_thread("live-answer");
        answer_requests();
      });
    }
  }

  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      for (const int socket : answering_) shutdown(socket, SHUT_RDWR);
    }
    eventfd_write(wake_.get(), 1);
    queue_filled_.notify_all();
    threads_.clear();
    waiting_.clear();
  }

 private:
  struct Waiting {
    FileDescriptor socket;
    SteadyTime until;
  };

  void accept_and_wait() {
    std::vector<pollfd> polled{{wake_.get(), POLLIN, 0}, {listener_.get(), POLLIN, 0}};
    for (const Waiting& connection : waiting_) {
      polled.push_back({connection.socket.get(), POLLIN, 0});
    }
    constexpr int kPatience_ms = 1000;  // so that connections that waited too long are closed
    if (poll(polled.data(), polled.size(), kPatience_ms) < 0) return;
    const SteadyTime now = std::chrono::steady_clock::now();
    size_t index = 2;
    for (auto connection = waiting_.begin(); connection != waiting_.end(); ++index) {
      const bool ready = polled[index].revents != 0;
      if (ready) hand_over(std::move(connection->socket));
      connection = ready || connection->until < now ? waiting_.erase(connection) : ++connection;
    }
    if (polled[1].revents != 0) accept_all(now);
  }

  void accept_all(SteadyTime now) {
    while (true) {
      FileDescriptor socket(
          accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (socket.get() < 0) break;
      setsockopt(socket.get(), SOL_SOCKET, SO_SNDBUF, &kSendBuffer_bytes,
                 sizeof(kSendBuffer_bytes));
      if (waiting_.size() >= limits_.waiting) waiting_.pop_front();
      waiting_.push_back({std::move(socket), now + limits_.idle});
    }
    // Without a free file descriptor, poll() would return at once, again and again.
    if (errno == EMFILE || errno == ENFILE) {
      waiting_.clear();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  void hand_over(FileDescriptor socket) {
    {
      const std::lock_guard lock(mutex_);
      if (queue_.size() >= limits_.queued) return;
      queue_.push_back(std::move(socket));
    }
    queue_filled_.notify_one();
  }

  void answer_requests() {
    while (true) {
      std::unique_lock lock(mutex_);
      queue_filled_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
      if (stopping_) return;
      const FileDescriptor socket = std::move(queue_.front());
      queue_.pop_front();
      answering_.push_back(socket.get());
      lock.unlock();
      SocketStream stream(socket, limits_);
      responder_.answer(stream);
      shutdown(socket.get(), SHUT_WR);
      lock.lock();
      std::erase(answering_, socket.get());
    }
  }

  const HttpLimits limits_;
  Responder responder_;
  FileDescriptor listener_;
  FileDescriptor wake_;
  const int port_;
  std::list<Waiting> waiting_;  ///< oldest first; used by the accepting thread only
  std::mutex mutex_;            ///< guards the next three
  std::condition_variable queue_filled_;
  std::deque<FileDescriptor> queue_;
  std::vector<int> answering_;  ///< sockets that the workers answer
  std::atomic<bool> stopping_{false};
  std::vector<std::jthread> threads_;
};

Result<std::unique_ptr<HttpServer>> HttpServer::open(const std::string& address, int port,
                                                     const HttpLimits& limits) {
  auto listener = listen_at(address, port);
  if (!listener) return tl::unexpected(listener.error());
  return std::unique_ptr<HttpServer>(
      new HttpServer(std::make_unique<Impl>(std::move(*listener), limits)));
}

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpServer::~HttpServer() = default;

void HttpServer::get(const std::string& path, Handler handler) {
  impl_->responder().Get(path, std::move(handler));
}

void HttpServer::set_headers(const std::vector<std::pair<std::string, std::string>>& headers) {
  impl_->responder().set_default_headers({headers.begin(), headers.end()});
}

void HttpServer::start() {
  impl_->start();
}

void HttpServer::stop() {
  impl_->stop();
}

int HttpServer::port() const {
  return impl_->port();
}

}  // namespace bevloc::firmware
