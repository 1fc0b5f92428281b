#include "firmware/telemetry/view_log.h"

#include <spdlog/spdlog.h>

namespace bevloc::firmware {

void ViewLog::note(const ApplianceView& view) {
  if (view.state != before_.state) {
    const std::string why = to_string(view.why);
    spdlog::info("state {} -> {}{}{}", to_string(before_.state), to_string(view.state),
                 why.empty() ? "" : ": ", why);
  }
  if (view.bus != before_.bus) {
    spdlog::warn("CAN {} -> {}", can::to_string(before_.bus), can::to_string(view.bus));
  }
  if (view.hung != before_.hung) {
    if (view.hung.empty()) {
      spdlog::info("every thread makes progress again");
    } else {
      spdlog::error("no progress in thread {}; systemd restarts bevlocd if it lasts", view.hung);
    }
  }
  note_drifts(view);
  note_frozen(view.frozen);
  before_ = view;
}

void ViewLog::note_drifts(const ApplianceView& view) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const double ppm = view.drift_ppm[camera];
    const double before_ppm = before_.drift_ppm[camera];
    if (ppm != 0.0 && before_ppm == 0.0) {
      spdlog::warn(
          "camera {}: drift of {:+.0f} ppm against the median camera; use a trigger, or "
          "compensate_motion with a wide tolerance_ms",
          kCameraNames[camera], ppm);
    } else if (ppm == 0.0 && before_ppm != 0.0) {
      spdlog::info("camera {}: no drift any more", kCameraNames[camera]);
    }
  }
}

void ViewLog::note_frozen(CameraMask frozen) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (frozen[camera] == before_.frozen[camera]) continue;
    if (frozen[camera]) {
      spdlog::warn(
          "camera {}: frozen, repeats the same image while the vehicle drives; power-cycle the "
          "camera and check its lens",
          kCameraNames[camera]);
    } else {
      spdlog::info("camera {}: no longer frozen", kCameraNames[camera]);
    }
  }
}

}  // namespace bevloc::firmware
