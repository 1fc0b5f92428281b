// Tells the service manager how the daemon is (sd_notify(3)).
#pragma once

#include <string>

namespace bevloc::firmware {

/// Without a service manager every call does nothing. One thread.
class ServiceNotifier {
 public:
  void ready();
  void stopping();
  /// The line that `systemctl status` shows; sent when it changes.
  void status(const std::string& text);
  /// To be called only when every stage has made progress since the last call.
  void feed_watchdog();

 private:
  std::string sent_status_;
};

}  // namespace bevloc::firmware
