// A gpsd on the loopback interface that says what the test tells it.
#pragma once

#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bevloc::test {

/// Listens from its construction on. One thread.
class MockGpsd {
 public:
  MockGpsd() : listening_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(listening_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listening_, 4), 0);
    getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~MockGpsd() {
    hang_up();
    stop_listening();
  }
  MockGpsd(const MockGpsd&) = delete;
  MockGpsd& operator=(const MockGpsd&) = delete;

  uint16_t port() const { return port_; }

  /// Accepts the client, which has to be connected or connecting.
  void accept_client() { client_ = accept(listening_, nullptr, nullptr); }
  /// The bytes that the client sent; waits for the first of them.
  std::string heard() const {
    char text[256] = {};
    const ssize_t count = recv(client_, text, sizeof(text), 0);
    return {text, count > 0 ? static_cast<size_t>(count) : 0};
  }
  void say(const std::string& text) const {
    EXPECT_EQ(send(client_, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  void hang_up() {
    if (client_ >= 0) close(client_);
    client_ = -1;
  }
  void stop_listening() {
    if (listening_ >= 0) close(listening_);
    listening_ = -1;
  }

 private:
  int listening_;
  int client_ = -1;
  uint16_t port_ = 0;
};

}  // namespace bevloc::test
