// One connection of the HTTP server, with limits in time and size.
#pragma once

#include <string>
#include <vector>

#include "firmware/live/http_server.h"
#include "firmware/live/httplib_header.h"

namespace bevloc::firmware {

/// Owns a socket, and closes it at its end.
class Socket {
 public:
  explicit Socket(int file = -1) : file_(file) {}
  Socket(Socket&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }
  ~Socket();

  int get() const { return file_; }

 private:
  int file_;
};

/// cpp-httplib reads a request from this stream and writes the response to it. Reading fails when
/// the request is not complete in time, or too long. Writing fails when the client does not read.
/// One thread.
class SocketStream final : public httplib::Stream {
 public:
  /// `socket` must be non-blocking and outlive this.
  SocketStream(const Socket& socket, const HttpLimits& limits);

  bool is_readable() const override { return true; }
  bool is_writable() const override;
  ssize_t read(char* text, size_t size) override;
  ssize_t write(const char* text, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_.get(); }

 private:
  bool fill();

  const Socket& socket_;
  const HttpLimits& limits_;
  const std::chrono::steady_clock::time_point read_until_;
  size_t read_bytes_ = 0;
  std::vector<char> buffer_;  ///< bytes that were received; those from next_ on are not read yet
  size_t next_ = 0;
};

}  // namespace bevloc::firmware
