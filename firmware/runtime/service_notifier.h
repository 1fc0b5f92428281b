// Reports the daemon's state to the service manager (sd_notify(3)).
#pragma once

#include <string>

#include "common/time.h"

namespace bevloc::firmware {

/// Reports to the service manager. All calls do nothing if there is none. One thread.
class ServiceNotifier {
 public:
  /// Reports that the daemon is ready, and sets the watchdog timeout to that of the unit again.
  void ready();
  void stopping();
  /// Sets the line that `systemctl status` shows. It is sent only when it changes.
  void status(const std::string& text);
  /// Call it only while every thread makes progress.
  void feed_watchdog();
  /// Changes the watchdog timeout until ready() is called, if the unit has a watchdog.
  void set_watchdog_timeout(Duration timeout);

 private:
  std::string sent_status_;
};

}  // namespace bevloc::firmware
