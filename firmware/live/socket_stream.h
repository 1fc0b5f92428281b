// One connection of the HTTP server, with limits in time and size.
#pragma once

#include <string>
#include <vector>

#include "common/file_descriptor.h"
#include "firmware/live/http_server.h"
#include "firmware/live/httplib_header.h"

namespace bevloc::firmware {

/// cpp-httplib reads a request from this stream and writes the response to it. Reading fails when
/// the request is not complete in time, or too long. Writing fails when the client does not read.
/// One thread.
class SocketStream final : public httplib::Stream {
 public:
  /// `socket` must be non-blocking and outlive this.
  SocketStream(const FileDescriptor& socket, const HttpLimits& limits);

  bool is_readable() const override { return true; }
  bool is_writable() const override;
  ssize_t read(char* text, size_t size) override;
  ssize_t write(const char* text, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_.get(); }

 private:
  bool fill();

  const FileDescriptor& socket_;
  const HttpLimits& limits_;
  const std::chrono::steady_clock::time_point read_until_;
  size_t read_bytes_ = 0;
  std::vector<char> buffer_;  ///< bytes that were received; those from next_ on are not read yet
  size_t next_ = 0;
};

}  // namespace bevloc::firmware
