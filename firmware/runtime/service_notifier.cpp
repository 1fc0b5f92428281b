#include "firmware/runtime/service_notifier.h"

#include <systemd/sd-daemon.h>

namespace bevloc::firmware {

void ServiceNotifier::ready() {
  sd_notify(0, "READY=1");
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

}  // namespace bevloc::firmware
