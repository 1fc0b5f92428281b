// Lines of text over a stream socket.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace bevloc::hil {

/// One end of a connected socket, read without waiting. One thread.
class LineChannel {
 public:
  explicit LineChannel(int fd) : fd_(fd) {}
  ~LineChannel();
  LineChannel(const LineChannel&) = delete;
  LineChannel& operator=(const LineChannel&) = delete;

  int fd() const { return fd_; }

  /// Hands over each whole line that has come, and sends the answer, if it is not empty. False when
  /// the other end is gone.
  bool serve(const std::function<std::string(std::string_view)>& answer);

 private:
  int fd_;
  std::string received_;
};

/// A socket that waits for connections at `path`, or -1; a socket that is there is replaced.
int listen_unix(const std::string& path);
int accept_connection(int listener);

}  // namespace bevloc::hil
