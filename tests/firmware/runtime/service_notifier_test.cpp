#include "firmware/runtime/service_notifier.h"

#include <cstdlib>
#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace bevloc::firmware {
namespace {

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
  /// The next message; empty if there is none.
  std::string next() {
    char text[512];
    const ssize_t size = recv(socket_, text, sizeof(text), 0);
    return size > 0 ? std::string(text, static_cast<size_t>(size)) : std::string();
  }

 private:
  int socket_;
};

TEST(ServiceNotifierTest, SpeaksTheManagersProtocol) {
  FakeManager manager;
  ServiceNotifier notifier;
  notifier.ready();
  EXPECT_EQ(manager.next(), "READY=1");
  notifier.feed_watchdog();
  EXPECT_EQ(manager.next(), "WATCHDOG=1");
  notifier.stopping();
  EXPECT_EQ(manager.next(), "STOPPING=1");
}

TEST(ServiceNotifierTest, SendsAStatusOnlyWhenItChanges) {
  FakeManager manager;
  ServiceNotifier notifier;
  notifier.status("TRACKING, cameras 6/6");
  notifier.status("TRACKING, cameras 6/6");
  notifier.status("DEGRADED: camera missing, cameras 5/6");
  EXPECT_EQ(manager.next(), "STATUS=TRACKING, cameras 6/6");
  EXPECT_EQ(manager.next(), "STATUS=DEGRADED: camera missing, cameras 5/6");
  EXPECT_EQ(manager.next(), "");
}

TEST(ServiceNotifierTest, DoesNothingWithoutAManager) {
  unsetenv("NOTIFY_SOCKET");
  ServiceNotifier notifier;
  notifier.ready();
  notifier.feed_watchdog();
}

}  // namespace
}  // namespace bevloc::firmware
