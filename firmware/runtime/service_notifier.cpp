#include "firmware/runtime/service_notifier.h"

#include <cstdlib>

#include <systemd/sd-daemon.h>

namespace bevloc::firmware {

void ServiceNotifier::ready() {
  // systemd sets the variable to the unit's WatchdogSec=, in microseconds.
  const char* timeout_us = std::getenv("WATCHDOG_USEC");
  if (timeout_us == nullptr) {
    sd_notify(0, "READY=1");
  } else {
    sd_notifyf(0, "READY=1\nWATCHDOG_USEC=%s", timeout_us);
  }
}

void ServiceNotifier::stopping() {
  sd_notify(0, "STOPPING=1");
}

void ServiceNotifier::status(const std::string& text) {
  if (text == sent_status_) return;
  sent_status_ = text;
  sd_notify(0, ("STATUS=" + text).c_str());
}

void ServiceNotifier::feed_watchdog() {
  sd_notify(0, "WATCHDOG=1");
}

void ServiceNotifier::set_watchdog_timeout(Duration timeout) {
  if (std::getenv("WATCHDOG_USEC") == nullptr) return;
  const auto timeout_us = std::chrono::duration_cast<std::chrono::microseconds>(timeout).count();
  sd_notifyf(0, "WATCHDOG_USEC=%lld", static_cast<long long>(timeout_us));
}

}  // namespace bevloc::firmware
