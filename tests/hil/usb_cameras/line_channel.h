// Exchanges lines of text over a stream socket.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace bevloc::hil {

/// One end of a connected socket, which it owns and reads without blocking. One thread.
class LineChannel {
 public:
  explicit LineChannel(int fd) : fd_(fd) {}
  ~LineChannel();
  LineChannel(const LineChannel&) = delete;
  LineChannel& operator=(const LineChannel&) = delete;

  int fd() const { return fd_; }

  /// Calls `answer` with each complete line received and sends its result unless it is empty.
  /// Returns false when the other end has closed.
  bool serve(const std::function<std::string(std::string_view)>& answer);

 private:
  int fd_;
  std::string received_;
};

/// Returns a non-blocking socket that listens at `path`, or -1. Replaces an existing socket.
int listen_unix(const std::string& path);
/// Returns the next connection, non-blocking, or -1.
int accept_connection(int listener);

}  // namespace bevloc::hil
