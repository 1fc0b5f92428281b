// An HTTP server with bounded threads, connections, times and sizes.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/result.h"
#include "common/time.h"

namespace httplib {
struct Request;
struct Response;
}  // namespace httplib

namespace bevloc::firmware {

/// How much a client can use up. A connection beyond a limit is closed.
struct HttpLimits {
  size_t waiting = 64;  ///< connections that have not sent a byte yet; the oldest one is closed
  size_t workers = 8;   ///< threads, which is the number of requests at the same time
  size_t queued = 32;   ///< requests that wait for a thread
  Duration idle = std::chrono::seconds(10);    ///< time until the first byte of a request
  Duration request = std::chrono::seconds(3);  ///< time from the request's first byte to its last
  Duration write = std::chrono::seconds(3);    ///< time until the client accepts the next bytes
  size_t request_bytes = 16384;                ///< size of request line and headers
};

/// Answers GET and HEAD. Each connection carries one request. cpp-httplib parses the request and
/// writes the response. This class accepts, limits and closes the connections. So a slow or hostile
/// client occupies a bounded number of threads for a bounded time. A request whose Host header is a
/// name other than "localhost" gets 403. So a page of a foreign site cannot read the answers by
/// letting its own name point here (DNS rebinding). A Range header is ignored.
///
/// Starts `workers` threads that answer and one thread that accepts, all with the lowest priority
/// of the normal scheduler. One thread. The handlers run in the threads that answer.
class HttpServer {
 public:
  using Handler = std::function<void(const httplib::Request&, httplib::Response&)>;

  /// Listens at `address` (an IP address in numbers). Port 0 takes a free one. Fails if the port
  /// is taken or the address is not one of this machine.
  static Result<std::unique_ptr<HttpServer>> open(const std::string& address, int port,
                                                  const HttpLimits& limits = {});
  /// Closes all connections and ends all threads.
  ~HttpServer();

  /// Adds a route. Call it before start().
  void get(const std::string& path, Handler handler);
  /// Sets headers of every response. Call it before start().
  void set_headers(const std::vector<std::pair<std::string, std::string>>& headers);
  void start();
  /// Closes all connections and ends all threads. Handlers that wait must have been told to end.
  void stop();

  int port() const;

 private:
  class Impl;
  class Responder;
  explicit HttpServer(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace bevloc::firmware
