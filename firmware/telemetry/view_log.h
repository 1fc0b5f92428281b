// Logs changes of the appliance state while it runs.
#pragma once

#include "firmware/runtime/supervisor.h"

namespace bevloc::firmware {

/// Thread-bound: called from the supervising thread.
class ViewLog {
 public:
  /// Logs what changed since the previous view.
  void note(const ApplianceView& view);

 private:
  void note_drifts(const ApplianceView& view);
  void note_frozen(CameraMask frozen);

  ApplianceView before_;
};

}  // namespace bevloc::firmware
