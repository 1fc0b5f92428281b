// What of the appliance's state goes into the log: its changes.
#pragma once

#include "firmware/supervisor.h"

namespace bevloc::firmware {

/// Of the supervising thread.
class ViewLog {
 public:
  /// Logs what is different from the view before.
  void note(const ApplianceView& view);

 private:
  void note_drifts(const ApplianceView& view);
  void note_frozen(CameraMask frozen);

  ApplianceView before_;
};

/// At the end. `trigger` may be null.
void log_synchrony(const SynchronyCounters& synchrony, const drivers::Trigger* trigger);

}  // namespace bevloc::firmware
