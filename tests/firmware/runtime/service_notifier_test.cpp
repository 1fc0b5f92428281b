#include "firmware/runtime/service_notifier.h"

#include "tests/firmware/runtime/fake_manager.h"

namespace bevloc::firmware {
namespace {

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

TEST(ServiceNotifierTest, ChangesTheWatchdogTimeoutUntilReady) {
  FakeManager manager;
  ServiceNotifier notifier;
  setenv("WATCHDOG_USEC", "2000000", 1);
  notifier.set_watchdog_timeout(std::chrono::seconds(30));
  notifier.ready();
  unsetenv("WATCHDOG_USEC");
  EXPECT_EQ(manager.next(), "WATCHDOG_USEC=30000000");
  EXPECT_EQ(manager.next(), "READY=1\nWATCHDOG_USEC=2000000");
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
  FakeManager manager;
  unsetenv("NOTIFY_SOCKET");
  ServiceNotifier notifier;
  notifier.ready();
  notifier.feed_watchdog();
  EXPECT_EQ(manager.all(), "");
}

}  // namespace
}  // namespace bevloc::firmware
