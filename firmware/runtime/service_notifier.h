// Reports the daemon's state to the service manager (sd_notify(3)).
#pragma once

#include <string>

namespace bevloc::firmware {

/// Without a service manager, all calls do nothing. One thread.
class ServiceNotifier {
 public:
  void ready();
  void stopping();
  /// Sets the line that `systemctl status` shows. Sent only when it changes.
  void status(const std::string& text);
  /// To be called only if every stage has made progress since the last call.
  void feed_watchdog();

 private:
  std::string sent_status_;
};

}  // namespace bevloc::firmware
