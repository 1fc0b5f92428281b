// A service manager that a test reads.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace bevloc::firmware {

/// Receives the messages in place of the service manager.
class FakeManager {
 public:
  FakeManager() : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    // An abstract address needs no file.
    const std::string name = "@bevloc-notify-" + std::to_string(getpid());
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path + 1, name.data() + 1, name.size() - 1);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), length), 0);
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~FakeManager() {
    unsetenv("NOTIFY_SOCKET");
    close(socket_);
  }
  FakeManager(const FakeManager&) = delete;
  FakeManager& operator=(const FakeManager&) = delete;

  /// All messages up to now, one per line.
  std::string all() {
    std::string text;
    for (std::string message = next(); !message.empty(); message = next()) text += message + '\n';
    return text;
  }
  /// The next message; empty if there is none.
  std::string next() {
    char text[512];
    const ssize_t size = recv(socket_, text, sizeof(text), 0);
    return size > 0 ? std::string(text, static_cast<size_t>(size)) : std::string();
  }

 private:
  int socket_;
};

}  // namespace bevloc::firmware
