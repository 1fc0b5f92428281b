// Logs changes of the appliance state while it runs.
#pragma once

#include <array>
#include <string_view>

#include "firmware/runtime/supervisor.h"
#include "firmware/telemetry/change_log.h"

namespace bevloc::firmware {

/// The state may change between TRACKING and DEGRADED many times a second, and so may the condition
/// of the bus. Such changes are logged once per cause (ChangeLog).
/// Thread-bound: called from the supervising thread.
class ViewLog {
 public:
  /// Logs what changed since the previous view. `now` is the time of the view.
  void note(const ApplianceView& view, Time now);

 private:
  void note_state(const ApplianceView& view, Time now);
  void note_drifts(const ApplianceView& view);
  void note_stamps(int offset_ms) const;
  void note_gnss_lag(int lag_ms) const;
  void note_map_offset(const std::array<int, 2>& offset_cm) const;
  static void note_cameras(CameraMask before, CameraMask now, std::string_view what,
                           std::string_view advice);

  ApplianceView before_;
  ChangeLog states_{to_string(ApplianceView().state)};
  ChangeLog bus_conditions_{can::to_string(ApplianceView().bus)};
};

}  // namespace bevloc::firmware
