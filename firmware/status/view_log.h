// Logs changes of the appliance state while it runs.
#pragma once

#include <array>
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
  void note_stamps(int offset_ms) const;
  void note_gnss_lag(int lag_ms) const;
  void note_map_offset(const std::array<int, 2>& offset_cm) const;
  static void note_cameras(CameraMask before, CameraMask now, std::string_view what,
                           std::string_view advice);

  ApplianceView before_;
};

}  // namespace bevloc::firmware
