// Logs changes of the appliance state while it runs.
#pragma once

#include <string_view>

#include "firmware/runtime/supervisor.h"

namespace bevloc::firmware {

/// Thread-bound: called from the supervising thread.
class ViewLog {
 public:
  /// Logs what changed since the previous view.
  void note(const ApplianceView& view);

 private:
  void note_drifts(const ApplianceView& view);
  static void note_cameras(CameraMask before, CameraMask now, std::string_view what,
                           std::string_view advice);

  ApplianceView before_;
};

}  // namespace bevloc::firmware
