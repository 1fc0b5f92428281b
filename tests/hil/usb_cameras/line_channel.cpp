#include "tests/hil/usb_cameras/line_channel.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace bevloc::hil {

LineChannel::~LineChannel() {
  close(fd_);
}

bool LineChannel::serve(const std::function<std::string(std::string_view)>& answer) {
  char chunk[4096];
  ssize_t count = 0;
  while ((count = recv(fd_, chunk, sizeof chunk, MSG_DONTWAIT)) > 0) {
    received_.append(chunk, static_cast<size_t>(count));
  }
  const bool alive = count < 0 && errno == EAGAIN;
  for (size_t end; (end = received_.find('\n')) != std::string::npos;) {
    const std::string reply = answer(std::string_view(received_).substr(0, end));
    received_.erase(0, end + 1);
    if (reply.empty()) continue;
    const std::string line = reply + '\n';
    if (::send(fd_, line.data(), line.size(), MSG_NOSIGNAL) < 0) return false;
  }
  return alive;
}

int listen_unix(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return -1;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  unlink(path.c_str());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(fd, 4) != 0) {
    close(fd);
    return -1;
  }
  return fd;
}

int accept_connection(int listener) {
  return accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
}

}  // namespace bevloc::hil
