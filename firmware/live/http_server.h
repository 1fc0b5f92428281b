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

/// What a client can use up. A connection beyond a limit is closed.
struct HttpLimits {
  size_t waiting = 64;  ///< connections without a complete first byte; the oldest one goes
  size_t workers = 8;   ///< threads, and so requests at the same time
  size_t queued = 32;   ///< requests that wait for a thread
  Duration idle = std::chrono::seconds(10);    ///< until the first byte of a request
  Duration request = std::chrono::seconds(3);  ///< from there until its last byte
  Duration write = std::chrono::seconds(3);    ///< until the client accepts the next bytes
  size_t request_bytes = 16384;                ///< request line and headers
};

/// Answers GET and HEAD; each connection carries one request. cpp-httplib parses the request and
/// writes the response; this class accepts, waits, limits and closes, so that a slow or hostile
/// client costs a bounded number of threads for a bounded time. A request whose Host header is a
/// name other than "localhost" gets 403: a page of a foreign site cannot read the answers by
/// letting its own name point here (DNS rebinding). A Range header is ignored.
///
/// Threads: `workers` and one that accepts, all with the lowest priority of the normal scheduler.
/// Every member is called from one thread; handlers run in the workers.
class HttpServer {
 public:
  using Handler = std::function<void(const httplib::Request&, httplib::Response&)>;

  /// Listens at `address` (an IP address in numbers). Port 0 takes a free one. Fails if the port
  /// is taken or the address is not one of this machine.
  static Result<std::unique_ptr<HttpServer>> open(const std::string& address, int port,
                                                  const HttpLimits& limits = {});
  /// Closes all connections and ends all threads.
  ~HttpServer();

  /// Adds a route. To be called before start().
  void get(const std::string& path, Handler handler);
  /// Headers of every response. To be called before start().
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

/// Whether a Host header names this machine by address or as "localhost".
bool is_local_host_header(const std::string& host);

}  // namespace bevloc::firmware
